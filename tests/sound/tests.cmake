# SPDX-License-Identifier: BSD-2-Clause
add_serial_test(sound wav ricochet_sound PkgConfig::SNDFILE)
