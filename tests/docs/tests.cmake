# SPDX-License-Identifier: BSD-2-Clause
add_program_test(docs tutorials LONG)
add_program_test(docs pages_run)
