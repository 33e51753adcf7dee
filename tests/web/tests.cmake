# SPDX-License-Identifier: BSD-2-Clause
add_program_test(web instrument)
set_tests_properties(web/instrument PROPERTIES COST 100 PROCESSORS 4)
add_program_test(web keyboard LONG)
set_tests_properties(web/keyboard PROPERTIES PROCESSORS 1)
add_program_test(web module)
add_program_test(web surfaces)
set_tests_properties(web/surfaces PROPERTIES PROCESSORS 1)  # most of its time is spent waiting for a browser
add_test(NAME web/rebuilt COMMAND ${PROJECT_SOURCE_DIR}/scripts/player --rebuild)
set_tests_properties(web/rebuilt PROPERTIES TIMEOUT 600 LABELS "programs;long" SKIP_RETURN_CODE 77)
