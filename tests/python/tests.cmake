# SPDX-License-Identifier: BSD-2-Clause
add_program_test(python commands)
add_program_test(python geometry)
add_program_test(python histories)
set_tests_properties(python/commands python/geometry python/histories PROPERTIES PROCESSORS 1)
add_program_test(python api)
add_program_test(python friction)
add_program_test(python notebooks LONG)
add_program_test(python style)
