# SPDX-License-Identifier: BSD-2-Clause
# Debian packages, made with cpack -G DEB, one for each component. Use scripts/package, which adds the manual pages.
if(DEFINED ENV{DEBEMAIL})
  set(packager "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
else()
  set(packager "Ricochet developers <developers@ricochet.invalid>")
endif()
set(CPACK_PACKAGE_NAME ricochet)
set(CPACK_PACKAGE_VENDOR "Ricochet")
set(CPACK_PACKAGE_CONTACT ${packager})
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL programs python library)
if(RICOCHET_PREPROCESSOR)
  list(APPEND CPACK_COMPONENTS_ALL eps)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_STRIP_FILES ON)

set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME ricochet)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_DEPENDS "openmpi-bin, python3-gmsh, python3-ricochet (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SUGGESTS "slurm-client")
set(CPACK_DEBIAN_PROGRAMS_DESCRIPTION "impact of elastic bodies from modal kernels
The command ricochet and programs that compute kernels of elastic bodies
from gmsh meshes, and impacts from kernels.
.
As ricochet-kernel is linked with gmsh, this package is distributed under
the GNU GPL, version 3 or later.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-ricochet)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
  "python3 (>= 3.11), python3 (<< 3.12), python3-numpy, python3-h5py, python3-matplotlib")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-meshio")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "ricochet (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_PYTHON_PACKAGE_GENERATE_SHLIBS OFF)
file(WRITE ${PROJECT_BINARY_DIR}/package/python/postinst "#!/bin/sh\nset -e\n[ \"$1\" != configure ] || py3compile -p python3-ricochet\n")
file(WRITE ${PROJECT_BINARY_DIR}/package/python/prerm "#!/bin/sh\nset -e\npy3clean -p python3-ricochet\n")
file(CHMOD ${PROJECT_BINARY_DIR}/package/python/postinst ${PROJECT_BINARY_DIR}/package/python/prerm PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/package/python/postinst
  ${PROJECT_BINARY_DIR}/package/python/prerm)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "impact of elastic bodies, from Python
The Python package ricochet: scenes, kernels, impacts, studies and
pictures as objects and NumPy arrays. The package ricochet has the
programs that compute kernels.
.
Distributed under the BSD licence of two clauses; nothing in it needs MPI,
PETSc or gmsh.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libricochet-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "libhdf5-dev, libfmt-dev")
file(WRITE ${PROJECT_BINARY_DIR}/package/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/package/triggers)
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "impact of elastic bodies, to embed
Headers, libraries and the CMake package Ricochet for programs that run
impacts from kernels.
.
Distributed under the BSD licence of two clauses; nothing in it needs MPI,
PETSc or gmsh.")
set(CPACK_DEBIAN_EPS_PACKAGE_NAME libricochet-eps-dev)
set(CPACK_DEBIAN_EPS_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_EPS_PACKAGE_DEPENDS "libslepc-real-dev, libpetsc-real-dev")
set(CPACK_DEBIAN_EPS_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/package/triggers)
set(CPACK_DEBIAN_EPS_DESCRIPTION "certified eigenpairs by spectrum slicing, for SLEPc
The eigensolver of Ricochet as a type of SLEPc's EPS: all eigenpairs of
symmetric K x = lambda M x in an interval, or the lowest ones, with a proof
that none is missing.
.
Distributed under the BSD licence of two clauses; nothing in it needs
gmsh.")
include(CPack)

# The files that Debian requires in the documentation folder of a package.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(READ LICENSE license)
string(REGEX REPLACE "^.*developers\n+" "" license "${license}")
string(STRIP "${license}" license)
string(REPLACE "\n\n" "\n.\n" license "${license}")
string(REPLACE "\n" "\n " license " ${license}")
function(add_documents component package comment)
  set(folder ${PROJECT_BINARY_DIR}/package/${package})
  configure_file(cmake/copyright.in ${folder}/copyright @ONLY)
  configure_file(cmake/changelog.in ${folder}/changelog @ONLY)
  execute_process(COMMAND gzip -9nf ${folder}/changelog COMMAND_ERROR_IS_FATAL ANY)
  install(FILES ${folder}/copyright ${folder}/changelog.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
endfunction()
add_documents(programs ricochet "The sources are under BSD-2-Clause. The program ricochet-kernel is linked with the gmsh library,
 which is under the GNU General Public License, version 2 or later, and with OpenSSL 3 and METIS, whose licence (Apache 2.0)
 goes with version 3 of it. So this package as a whole is distributed under the GPL, version 3 or later, see
 /usr/share/common-licenses/GPL-3. The packages libricochet-dev and python3-ricochet do not contain gmsh and stay under BSD-2-Clause.")
add_documents(python python3-ricochet "Nothing in this package is linked with what is under the GNU General Public License.")
add_documents(library libricochet-dev "Nothing in this package is linked with what is under the GNU General Public License.")
# What lintian reports of a package whose shared library has no package of its own.
function(add_overrides component package)
  set(file ${PROJECT_BINARY_DIR}/package/${package}.lintian)
  file(WRITE ${file}
"# The shared library is for programs that load it: it has no package of its own.
${package}: package-name-doesnt-match-sonames
${package}: link-to-shared-library-in-wrong-package
# CPack generates these scripts.
${package}: maintscript-calls-ldconfig
")
  install(FILES ${file} DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides COMPONENT ${component} RENAME ${package})
endfunction()
add_overrides(library libricochet-dev)
if(RICOCHET_PREPROCESSOR)
  add_documents(eps libricochet-eps-dev "Nothing in this package is linked with what is under the GNU General Public License.")
  add_overrides(eps libricochet-eps-dev)
endif()
