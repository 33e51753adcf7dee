# SPDX-License-Identifier: BSD-2-Clause
add_serial_tests(accuracy accuracy LIBRARIES ricochet_accuracy FILES around_first_touch contact_zone decision local_refinement settings)
