# SPDX-License-Identifier: BSD-2-Clause
add_serial_tests(scene scene LIBRARIES ricochet_scene
  FILES loads read refusals near_misses overrides request write derive accuracy keys strikes)
