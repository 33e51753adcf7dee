# SPDX-License-Identifier: BSD-2-Clause
add_serial_tests(player player LIBRARIES ricochet_player ricochet_contact FILES instrument player ../contact/heap_counter)
