# SPDX-License-Identifier: BSD-2-Clause
# The Python package `ricochet` and its command. In a checkout, the command runs the package from the source tree, with
# the extension module of the build. cmake --install BUILD --component python installs the package; the component
# programs contains the command.
set(python_path "${PROJECT_SOURCE_DIR}/python:${PROJECT_BINARY_DIR}/python")
configure_file(${CMAKE_CURRENT_LIST_DIR}/ricochet.in ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/ricochet @ONLY USE_SOURCE_PERMISSIONS)

set(python_path "$bin/../lib/python3/dist-packages")
configure_file(${CMAKE_CURRENT_LIST_DIR}/ricochet.in ${PROJECT_BINARY_DIR}/installed/ricochet @ONLY USE_SOURCE_PERMISSIONS)
install(PROGRAMS ${PROJECT_BINARY_DIR}/installed/ricochet DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
install(DIRECTORY python/ricochet DESTINATION lib/python3/dist-packages COMPONENT python PATTERN __pycache__ EXCLUDE)
