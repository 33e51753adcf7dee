# SPDX-License-Identifier: BSD-2-Clause
add_serial_tests(base base LIBRARIES ricochet_kernels PkgConfig::HDF5 ricochet_core
  FILES atomic_file hdf5 format memory rotation)
