# SPDX-License-Identifier: BSD-2-Clause
add_program_test(mutants mutants_test)
