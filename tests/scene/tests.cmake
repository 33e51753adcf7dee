# SPDX-License-Identifier: BSD-2-Clause
add_serial_tests(scene scene LIBRARIES ricochet_scene tomlplusplus::tomlplusplus
  FILES loads read refusals overrides request write derive accuracy keys strikes motion)
