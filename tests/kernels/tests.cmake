# SPDX-License-Identifier: BSD-2-Clause
add_serial_tests(kernels kernels LIBRARIES ricochet_kernels PkgConfig::HDF5
  FILES format damage validate whole band keeping compression algebra flexibility_error mesh_error modes_file expected_modes)
