# SPDX-License-Identifier: BSD-2-Clause
add_serial_tests(console console LIBRARIES ricochet_console
  FILES options console)
