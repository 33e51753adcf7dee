# SPDX-License-Identifier: BSD-2-Clause
add_serial_test(kernels format ricochet_kernels PkgConfig::HDF5)
add_serial_test(kernels damage ricochet_kernels PkgConfig::HDF5)
add_serial_test(kernels validate ricochet_kernels)
add_serial_test(kernels whole ricochet_kernels)
add_serial_test(kernels band ricochet_kernels Eigen3::Eigen)
add_serial_test(kernels keeping ricochet_kernels Eigen3::Eigen)
add_serial_test(kernels algebra ricochet_kernels Eigen3::Eigen)
add_serial_test(kernels flexibility_error ricochet_kernels Eigen3::Eigen)
