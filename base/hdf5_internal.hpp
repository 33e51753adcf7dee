// SPDX-License-Identifier: BSD-2-Clause
// Shared by the writer and the reader of HDF5 files. Not for other folders, because it needs the HDF5
// headers.
#pragma once

// Later releases of HDF5 still offer the functions of version 1.10 by their old names.
#define H5_USE_110_API
#include <hdf5.h>

#include "base/hdf5.hpp"

namespace ricochet::base::hdf5 {

static_assert(std::same_as<hid_t, std::int64_t>);

/// Suppresses the error stack that HDF5 prints, because our errors are one line. This holds for the thread
/// and permanently: if printing were restored, a damaged file would make HDF5 print again when the program
/// ends.
/// HDF5 also closes no files at exit: closing a file that a full disk keeps from being closed would crash
/// there.
inline void silence() {
  static const herr_t never_at_exit = H5dont_atexit();
  (void)never_at_exit;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

struct ElementType {
  hid_t memory, file;
};

/// Files are little-endian on every machine, so that equal kernels are equal files.
template <Element T>
ElementType element_type() {
  if constexpr (std::same_as<T, double>)
    return {H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE};
  else if constexpr (std::same_as<T, float>)
    return {H5T_NATIVE_FLOAT, H5T_IEEE_F32LE};
  else
    return {H5T_NATIVE_INT64, H5T_STD_I64LE};
}

/// Disables file locks. Only complete files have their final name, so locks protect nothing, and some network
/// file systems do not support them.
inline Id unlocked_access() {
  Id list(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_file_locking(list.get(), false, true);
  return list;
}

}  // namespace ricochet::base::hdf5
