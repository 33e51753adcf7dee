# SPDX-License-Identifier: BSD-2-Clause
# Needs the player in WebAssembly; scripts/setup --tests installs emscripten.
if(TARGET ricochet_web)
  add_program_test(web instrument)
  set_tests_properties(web/instrument PROPERTIES COST 100 PROCESSORS 4)
endif()
