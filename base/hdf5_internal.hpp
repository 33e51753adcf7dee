// SPDX-License-Identifier: BSD-2-Clause
// Declarations shared by the writer and the reader of HDF5 files. Other folders must not include this header,
// because it needs the HDF5 headers.
#pragma once

// Later releases of HDF5 still offer the functions of version 1.10 by their old names.
#define H5_USE_110_API
#include <hdf5.h>

#include "base/hdf5.hpp"

namespace ricochet::base::hdf5 {

static_assert(std::same_as<hid_t, std::int64_t>);

/// Suppresses the error stack that HDF5 prints, because Ricochet's errors have one line. The setting holds
/// permanently for this thread: if printing were restored, HDF5 would print errors of a damaged file again
/// when the program ends.
/// Also prevents HDF5 from closing files at exit, because it would crash if a full disk keeps a file from
/// being closed.
inline void silence() {
  static const herr_t never_at_exit = H5dont_atexit();
  (void)never_at_exit;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

struct ElementType {
  hid_t memory, file;
};

/// Files are little-endian on every machine, so that equal kernels give equal files.
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
