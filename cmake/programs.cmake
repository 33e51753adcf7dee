# SPDX-License-Identifier: BSD-2-Clause
# The programs with the scripts that run them: cmake --install BUILD --component programs. ricochet-kernel is linked with
# gmsh, so that what is distributed with it is under the GPL; the library is not (see cmake/install.cmake).
set(share ${CMAKE_INSTALL_DATADIR}/ricochet)
set(user_scripts run plot report sweep tradeoff batch import faust surfaces)
set(modules command_line programs titles progress result_file report_charts report_motion report_page report_run report_sound
  scene_keys sweep_study sweep_results sweep_pictures sweep_workers sweep_kernels tradeoff_runs tradeoff_report body_file calculix_model viewpoint plot_style plot_snapshots
  whole_file)

install(TARGETS ricochet-contact ricochet-recast COMPONENT programs)
if(RICOCHET_PREPROCESSOR)
  install(TARGETS ricochet-kernel COMPONENT programs)
endif()
foreach(command IN LISTS user_scripts)
  install(PROGRAMS scripts/${command} DESTINATION ${share}/scripts COMPONENT programs)
  set(link ${PROJECT_BINARY_DIR}/links/ricochet-${command})
  file(RELATIVE_PATH target ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_DATADIR}/ricochet/scripts/${command})
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/links)
  file(CREATE_LINK ${target} ${link} SYMBOLIC)
  install(FILES ${link} DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
endforeach()
foreach(module IN LISTS modules)
  install(FILES scripts/modules/${module}.py DESTINATION ${share}/scripts/modules COMPONENT programs)
endforeach()
install(DIRECTORY scripts/modules/report DESTINATION ${share}/scripts/modules COMPONENT programs)
install(DIRECTORY meshes DESTINATION ${share} COMPONENT programs
  PATTERN out EXCLUDE PATTERN *-surfaces.png EXCLUDE)
install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/ricochet COMPONENT programs)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/ricochet COMPONENT programs)
install(FILES cmake/completion.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT programs
  RENAME ricochet-contact)
foreach(other kernel recast ${user_scripts})
  set(link ${PROJECT_BINARY_DIR}/completions/ricochet-${other})
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/completions)
  file(CREATE_LINK ricochet-contact ${link} SYMBOLIC)
  install(FILES ${link} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT programs)
endforeach()
