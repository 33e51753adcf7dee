add_serial_test(kernels format ricochet_kernels PkgConfig::HDF5)
add_serial_test(kernels damage ricochet_kernels PkgConfig::HDF5)
add_serial_test(kernels validate ricochet_kernels)
add_serial_test(kernels hdf5 ricochet_kernels PkgConfig::HDF5)
