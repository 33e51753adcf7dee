# SPDX-License-Identifier: BSD-2-Clause
add_serial_tests(impact impact LIBRARIES ricochet_impact FILES warnings)
