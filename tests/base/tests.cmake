# SPDX-License-Identifier: BSD-2-Clause
add_serial_test(base atomic_file ricochet_kernels)
add_serial_test(base hdf5 ricochet_kernels PkgConfig::HDF5)
add_serial_test(base format ricochet_core)
