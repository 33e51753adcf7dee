# SPDX-License-Identifier: BSD-2-Clause
add_program_test(docs tutorials FIRST LONG)
add_program_test(docs pages_run FIRST)
add_program_test(docs quotes)
