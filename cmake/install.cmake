# SPDX-License-Identifier: BSD-2-Clause
# Installs the library for other programs, as package Ricochet: cmake --install BUILD --component library
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Ricochet)

install(TARGETS ricochet_base ricochet_core ricochet_kernels ricochet_contact ricochet
  EXPORT RicochetTargets COMPONENT library
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY include/ricochet DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT library PATTERN eps.h EXCLUDE)
install(EXPORT RicochetTargets NAMESPACE Ricochet:: DESTINATION ${package_dir} COMPONENT library)

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/RicochetConfig.cmake.in ${PROJECT_BINARY_DIR}/RicochetConfig.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/RicochetConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/RicochetConfig.cmake ${PROJECT_BINARY_DIR}/RicochetConfigVersion.cmake
  DESTINATION ${package_dir} COMPONENT library)

configure_file(${CMAKE_CURRENT_LIST_DIR}/ricochet.pc.in ${PROJECT_BINARY_DIR}/ricochet.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/ricochet.pc DESTINATION ${CMAKE_INSTALL_DATADIR}/pkgconfig COMPONENT library)

# The eigensolver for programs with K and M of their own: cmake --install BUILD --component eps
if(RICOCHET_PREPROCESSOR)
  install(TARGETS ricochet_eps LIBRARY COMPONENT eps NAMELINK_COMPONENT eps)
  install(FILES include/ricochet/eps.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/ricochet COMPONENT eps)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/ricochet-eps.pc.in ${PROJECT_BINARY_DIR}/ricochet-eps.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/ricochet-eps.pc DESTINATION ${CMAKE_INSTALL_DATADIR}/pkgconfig COMPONENT eps)
endif()
