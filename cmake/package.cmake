# Debian packages by cpack -G DEB, one for each licence: scripts/package makes them with everything in them.
set(CPACK_PACKAGE_NAME ricochet)
set(CPACK_PACKAGE_VENDOR "Ricochet")
set(CPACK_PACKAGE_CONTACT "Ricochet developers <ricochet@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Frictionless impact of elastic bodies from modal kernels")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL programs library)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_STRIP_FILES ON)

set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME ricochet)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_DEPENDS
  "openmpi-bin, python3 (>= 3.11), python3-numpy, python3-h5py, python3-matplotlib, python3-gmsh")
set(CPACK_DEBIAN_PROGRAMS_DESCRIPTION "Frictionless impact of elastic bodies from modal kernels
 Programs that compute kernels of elastic bodies from gmsh meshes, and impacts from kernels.
 .
 ricochet-kernel is linked with gmsh: this package is distributed under the GNU GPL, version 2 or later.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libricochet-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "libhdf5-dev, libfmt-dev")
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "Frictionless impact of elastic bodies, to embed
 Headers, libraries and the CMake package Ricochet for programs that run impacts from kernels.
 .
 Distributed under the BSD licence of two clauses; nothing in it needs MPI, PETSc or gmsh.")
include(CPack)
