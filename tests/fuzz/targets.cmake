# SPDX-License-Identifier: BSD-2-Clause
# The targets of scripts/fuzz. The tests replay the same files without libFuzzer (tests.cmake).
function(add_fuzz_target name)
  add_executable(fuzz_${name} ${PROJECT_SOURCE_DIR}/tests/fuzz/${name}.cpp)
  target_link_libraries(fuzz_${name} PRIVATE ${ARGN} fmt::fmt)
  target_link_options(fuzz_${name} PRIVATE -fsanitize=fuzzer)
endfunction()

add_fuzz_target(scene ricochet_scene tomlplusplus::tomlplusplus)
target_sources(fuzz_scene PRIVATE ${PROJECT_SOURCE_DIR}/tests/fuzz/toml.cpp)
add_fuzz_target(kernel ricochet_kernels PkgConfig::HDF5)
add_fuzz_target(table ricochet_contact PkgConfig::HDF5)
add_fuzz_target(surface ricochet_contact)
foreach(name kernel table)
  target_sources(fuzz_${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests/fuzz/hdf5_edits.cpp
    ${PROJECT_SOURCE_DIR}/tests/fuzz/hdf5_mutator.cpp)
endforeach()
if(RICOCHET_PREPROCESSOR)
  foreach(name mesh geometry)
    add_fuzz_target(${name} ricochet_fem ${GMSH_LIBRARY})
  endforeach()
  target_sources(fuzz_mesh PRIVATE ${PROJECT_SOURCE_DIR}/tests/fuzz/mesh_mutator.cpp)
endif()
# The parser marks some reachable states as unreachable.
set_source_files_properties(${PROJECT_SOURCE_DIR}/tests/fuzz/toml.cpp PROPERTIES COMPILE_OPTIONS -fno-sanitize=undefined)
