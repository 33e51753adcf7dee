# SPDX-License-Identifier: BSD-2-Clause
# Runs the targets of scripts/fuzz on their corpus without a fuzzer: inputs that once broke a reader,
# and inputs that reach deep into each reader.
function(add_replay name label)
  add_executable(test_fuzz_${name} fuzz/${name}.cpp fuzz/replay.cpp)
  target_link_libraries(test_fuzz_${name} PRIVATE ${ARGN} fmt::fmt)
  if(label STREQUAL serial)
    add_dependencies(serial_tests test_fuzz_${name})
  endif()
  add_test(NAME fuzz/${name} COMMAND test_fuzz_${name} ${CMAKE_CURRENT_SOURCE_DIR}/fuzz/corpus/${name})
  set_tests_properties(fuzz/${name} PROPERTIES TIMEOUT 120 LABELS ${label}
    ENVIRONMENT "OMP_NUM_THREADS=1;OPENBLAS_NUM_THREADS=1")
endfunction()

add_replay(scene serial ricochet_scene)
add_replay(kernel serial ricochet_kernels PkgConfig::HDF5 GTest::gtest)
add_replay(table serial ricochet_contact PkgConfig::HDF5)
add_replay(surface serial ricochet_contact)
foreach(name kernel table)
  target_sources(test_fuzz_${name} PRIVATE fuzz/hdf5_edits.cpp)
endforeach()
if(RICOCHET_PREPROCESSOR)
  foreach(name mesh geometry)
    add_replay(${name} mpi ricochet_fem ${GMSH_LIBRARY})
  endforeach()
endif()
