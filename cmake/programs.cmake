# SPDX-License-Identifier: BSD-2-Clause
# Installs programs, examples and documents: cmake --install BUILD --component programs. ricochet-kernel is linked with
# gmsh, so packages that contain it are under the GPL. Packages of the library are not (see cmake/install.cmake).
set(share ${CMAKE_INSTALL_DATADIR}/ricochet)

install(TARGETS ricochet-contact ricochet-recast COMPONENT programs)
if(RICOCHET_PREPROCESSOR)
  install(TARGETS ricochet-kernel COMPONENT programs)
  install(TARGETS ricochet-mesh DESTINATION ${CMAKE_INSTALL_BINDIR}/../libexec/ricochet COMPONENT programs)  # where ricochet-kernel looks for it
endif()
install(DIRECTORY meshes DESTINATION ${share} COMPONENT programs
  PATTERN out EXCLUDE PATTERN *-surfaces.png EXCLUDE)
install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/ricochet COMPONENT programs)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/ricochet COMPONENT programs)
set(completions ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES cmake/completion.bash DESTINATION ${completions} COMPONENT programs RENAME ricochet)
install(FILES cmake/completion.zsh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT programs RENAME _ricochet)
foreach(program ricochet ricochet-contact ricochet-kernel ricochet-recast)  # fish looks for a file of the command's name
  install(FILES cmake/completion.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT programs
    RENAME ${program}.fish)
endforeach()
foreach(program contact kernel recast)
  set(link ${PROJECT_BINARY_DIR}/completions/ricochet-${program})
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/completions)
  file(CREATE_LINK ricochet ${link} SYMBOLIC)
  install(FILES ${link} DESTINATION ${completions} COMPONENT programs)
endforeach()
