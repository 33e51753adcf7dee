# SPDX-License-Identifier: BSD-2-Clause
add_program_test(verification anisotropic)
add_program_test(verification box FIRST)
add_program_test(verification crystal_agreement FIRST LONG)
add_program_test(verification estimates FIRST LONG)
add_program_test(verification oracle_test)
add_program_test(verification peers_test)
add_program_test(verification extremes FIRST LONG)
add_program_test(verification verify)
set_tests_properties(verification/crystal_agreement PROPERTIES TIMEOUT 1800)  # 3 minutes of processor time

# Each short case of the validation manual is a separate test, which computes the case again. Those that take more than a few
# seconds run with scripts/test --long only.
set(quick bars belt falling_mass rods rods_analytic sphere two_balls)
file(GLOB cases CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/verification/cases/*.py)
foreach(file ${cases})
  file(STRINGS ${file} short REGEX "^LONG = False")
  if(short)
    get_filename_component(case ${file} NAME_WE)
    add_test(NAME verification/manual.${case} COMMAND ${PROJECT_SOURCE_DIR}/scripts/verify --again
      --cache ${CMAKE_CURRENT_BINARY_DIR}/manual ${case})
    set(labels programs)
    if(NOT case IN_LIST quick)
      list(APPEND labels long)
    endif()
    set_tests_properties(verification/manual.${case} PROPERTIES TIMEOUT 600 LABELS "${labels}"
      ENVIRONMENT "${one_thread};${waiting};RICOCHET_BIN=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
  endif()
endforeach()

# Built on demand by scripts/verify --meetings.
add_executable(random_meetings EXCLUDE_FROM_ALL verification/random_meetings.cpp)
target_link_libraries(random_meetings PRIVATE ricochet_core fmt::fmt Eigen3::Eigen)
