# SPDX-License-Identifier: BSD-2-Clause
add_serial_tests(lv2 lv2 LIBRARIES ricochet_plugin ricochet_contact ${CMAKE_DL_LIBS} FILES plugin ../contact/heap_counter)
add_dependencies(test_lv2 ricochet_lv2)
target_compile_definitions(test_lv2 PRIVATE RICOCHET_LV2="$<TARGET_FILE:ricochet_lv2>")
