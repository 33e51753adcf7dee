// SPDX-License-Identifier: BSD-2-Clause
// What the writer and the reader of HDF5 files share. Not for other folders: it needs the HDF5 headers.
#pragma once

// Later releases of HDF5 still offer the functions of 1.10 by their old names.
#define H5_USE_110_API
#include <hdf5.h>

#include "base/hdf5.hpp"

namespace ricochet::base::hdf5 {

static_assert(std::same_as<hid_t, std::int64_t>);

/// HDF5 prints its own error stack; ours are one line. For the thread and for good: were printing restored, a
/// damaged file would make HDF5 complain once more when the program ends.
/// And when the program ends HDF5 closes no file: one that a full disk keeps from closing crashes it there.
inline void silence() {
  static const herr_t never_at_exit = H5dont_atexit();
  (void)never_at_exit;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

template <Element T>
hid_t memory_type() {
  if constexpr (std::same_as<T, double>)
    return H5T_NATIVE_DOUBLE;
  else if constexpr (std::same_as<T, float>)
    return H5T_NATIVE_FLOAT;
  else
    return H5T_NATIVE_INT64;
}

/// Final names only ever belong to whole files, so locks protect nothing, and some network file systems lack
/// locks.
inline Id unlocked_access() {
  Id list(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_file_locking(list.get(), false, true);
  return list;
}

}  // namespace ricochet::base::hdf5
