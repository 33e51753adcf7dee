# SPDX-License-Identifier: BSD-2-Clause
add_serial_tests(sound sound LIBRARIES ricochet_sound PkgConfig::SNDFILE
  FILES receiver_sounds shaping wav)
