# SPDX-License-Identifier: BSD-2-Clause
# Included by project() in builds of scripts/mutants. The libraries under test compile each file by itself, so that a
# mutant compiles one file, and without warnings, which a mutant may cause.
foreach(library core contact kernels scene engine fem)
  cmake_language(EVAL CODE "
    cmake_language(DEFER CALL set_target_properties ricochet_${library} PROPERTIES UNITY_BUILD OFF)
    cmake_language(DEFER CALL target_compile_options ricochet_${library} PRIVATE -w)")
endforeach()
