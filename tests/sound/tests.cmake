add_serial_test(sound wav ricochet_sound PkgConfig::SNDFILE)
