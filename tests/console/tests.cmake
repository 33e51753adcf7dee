# SPDX-License-Identifier: BSD-2-Clause
add_serial_test(console options ricochet_console)
add_serial_test(console console ricochet_console)
