# SPDX-License-Identifier: BSD-2-Clause
add_serial_tests(contact_core contact LIBRARIES ricochet_core
  FILES islands look_ahead_block complementarity_limits bordered_factor friction_factor friction_solver friction_stepper friction_energy springs extremes heap_counter)
add_serial_tests(contact contact LIBRARIES ricochet_contact nlohmann_json::nlohmann_json PkgConfig::HDF5
  FILES complementarity contact_sides folding forced_response free_flight history event_location complementarity_bench convolution
    stepper floating sleeping coriolis rolling turning_loads turning_figures meeting impulse_stepper limited_steps propagator model pairing surface_projection reach receivers recorder entry_rows
     records
    band_share resolution_check obstacle_check obstacles moving_obstacles passage_check pressure_check ripple_check static_start decimator shock angular_momentum stress_envelope summary simulation changing_bodies denormals endurance stored_state point_forces table
    table_file equilibrium friction_equilibrium coarsening estimate first_touch heap_counter)
add_serial_tests(contact_realtime contact LIBRARIES ricochet_contact FILES realtime heap_counter)
set_source_files_properties(contact/heap_counter.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)

# The core links and includes nothing from higher layers. This test has no precompiled
# header, which would bring in other libraries.
add_executable(test_contact_core_alone contact/core_alone.cpp)
target_link_libraries(test_contact_core_alone PRIVATE ricochet_core GTest::gtest_main)
add_dependencies(serial_tests test_contact_core_alone)
gtest_discover_tests(test_contact_core_alone PROPERTIES TIMEOUT ${serial_timeout} LABELS serial)
add_test(NAME contact/core_includes
  COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/contact/core_includes.py ${CMAKE_CXX_COMPILER} ${PROJECT_SOURCE_DIR}
    $<TARGET_PROPERTY:Eigen3::Eigen,INTERFACE_INCLUDE_DIRECTORIES>)
set_tests_properties(contact/core_includes PROPERTIES TIMEOUT 120 LABELS serial)
