# SPDX-License-Identifier: BSD-2-Clause
# Makes manual pages of the command, its verbs and the programs from their --help.
find_program(HELP2MAN help2man REQUIRED)
set(manuals ${PROJECT_BINARY_DIR}/manuals)
file(MAKE_DIRECTORY ${manuals})
file(GLOB_RECURSE package_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/python/ricochet/*.py)
set(command ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/ricochet)
if(RICOCHET_PYTHON)
  list(APPEND package_sources ricochet_python)  # verbs import the extension module
endif()

# Adds the page NAME for the command line `program [VERB]`.
function(add_manual name purpose program)
  cmake_parse_arguments(PARSE_ARGV 3 manual "" VERB DEPENDS)
  string(TOUPPER ${name} title)
  add_custom_command(OUTPUT ${manuals}/${name}.1.gz
    COMMAND ${CMAKE_COMMAND} -E env RICOCHET_BIN=${CMAKE_RUNTIME_OUTPUT_DIRECTORY} OMPI_MCA_btl=self COLUMNS=1000
      ${HELP2MAN} --locale C.UTF-8 --no-info --name ${purpose} --output ${manuals}/${name}.1
      "--help-option=${manual_VERB} --help" "--version-option=${manual_VERB} --version" ${program}
    COMMAND sed -i -e "s/^[.]TH [^ ]*/.TH ${title}/" -e "/^[.]SH NAME/{n;s/^[^ ]*/${name}/}"
      -f ${PROJECT_SOURCE_DIR}/cmake/manual.sed ${manuals}/${name}.1
    COMMAND gzip -9nf ${manuals}/${name}.1
    DEPENDS ${program} ricochet-contact ${manual_DEPENDS} VERBATIM)
  set_property(GLOBAL APPEND PROPERTY ricochet_manuals ${manuals}/${name}.1.gz)
endfunction()

add_manual(ricochet-contact "computes an impact from kernels" ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/ricochet-contact)
add_manual(ricochet-recast "rescales and cuts a kernel" ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/ricochet-recast)
if(RICOCHET_PREPROCESSOR)
  add_manual(ricochet-kernel "computes kernels of elastic bodies" ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/ricochet-kernel)
endif()
add_manual(ricochet "impact of elastic bodies from modal kernels" ${command} DEPENDS ${package_sources})
# The verbs and their purposes are read from the source of the command.
file(STRINGS ${PROJECT_SOURCE_DIR}/python/ricochet/cli/__init__.py verbs REGEX "^    \"[a-z]+\": \".*\",$")
foreach(line IN LISTS verbs)
  string(REGEX REPLACE "^    \"([a-z]+)\": \"(.*)\",$" "\\1;\\2" line "${line}")
  list(POP_FRONT line verb purpose)
  if(NOT verb STREQUAL "kernel")  # the page of the program has this name
    add_manual(ricochet-${verb} "${purpose}" ${command} VERB ${verb} DEPENDS ${package_sources})
  endif()
endforeach()

get_property(pages GLOBAL PROPERTY ricochet_manuals)
add_custom_target(manuals ALL DEPENDS ${pages})
install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT programs)
