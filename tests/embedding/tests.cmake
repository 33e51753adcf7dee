# SPDX-License-Identifier: BSD-2-Clause
# The library as users get it: installed, found from outside the tree, linked from C++ and C, loaded by Python.
set(prefix ${CMAKE_CURRENT_BINARY_DIR}/installed)
set(outside ${CMAKE_CURRENT_BINARY_DIR}/outside)
add_test(NAME embedding/install
  COMMAND ${CMAKE_COMMAND} --install ${PROJECT_BINARY_DIR} --component library --prefix ${prefix})
add_test(NAME embedding/outside
  COMMAND ${CMAKE_CTEST_COMMAND} --build-and-test ${CMAKE_CURRENT_SOURCE_DIR}/embedding/outside ${outside}
    --build-generator ${CMAKE_GENERATOR}
    --build-options -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE}
      -DMANUAL=${PROJECT_SOURCE_DIR}/docs/embedding.md
    --test-command ${CMAKE_CTEST_COMMAND} --output-on-failure)
add_test(NAME embedding/shared
  COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/embedding/shared.py ${prefix} ${outside}/bob.kernel.h5)
set_tests_properties(embedding/install PROPERTIES FIXTURES_SETUP installed)
set_tests_properties(embedding/outside PROPERTIES FIXTURES_REQUIRED installed FIXTURES_SETUP outside)
set_tests_properties(embedding/shared PROPERTIES FIXTURES_REQUIRED "installed;outside")
set(tests embedding/install embedding/outside embedding/shared)

if(RICOCHET_EXAMPLES)
  add_test(NAME embedding/strike
    COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/embedding/strike.py $<TARGET_FILE:strike> ${CMAKE_CURRENT_BINARY_DIR}/strike)
  add_test(NAME embedding/example
    COMMAND ${CMAKE_CTEST_COMMAND} --build-and-test ${PROJECT_SOURCE_DIR}/examples/strike ${CMAKE_CURRENT_BINARY_DIR}/example
      --build-generator ${CMAKE_GENERATOR} --build-options -DCMAKE_PREFIX_PATH=${prefix})
  set_tests_properties(embedding/example PROPERTIES FIXTURES_REQUIRED installed)
  list(APPEND tests embedding/strike embedding/example)
endif()
set_tests_properties(${tests} PROPERTIES TIMEOUT 300 LABELS serial ENVIRONMENT PYTHONDONTWRITEBYTECODE=1)
