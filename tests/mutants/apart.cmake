# SPDX-License-Identifier: BSD-2-Clause
# Included by project() in builds that change one source at a time. The libraries in RICOCHET_APART compile each file by itself, so
# that a change compiles one file, and without warnings, which a change may cause.
if(NOT DEFINED RICOCHET_APART)
  set(RICOCHET_APART core contact kernels scene engine fem)
endif()
foreach(library ${RICOCHET_APART})
  cmake_language(EVAL CODE "
    cmake_language(DEFER CALL set_target_properties ricochet_${library} PROPERTIES UNITY_BUILD OFF)
    cmake_language(DEFER CALL target_compile_options ricochet_${library} PRIVATE -w)")
endforeach()
