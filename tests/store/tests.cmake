# SPDX-License-Identifier: BSD-2-Clause
add_serial_tests(store store LIBRARIES ricochet_store FILES body_warnings placement_store)
