# SPDX-License-Identifier: BSD-2-Clause
# Manual pages of all programs, generated from --help under their installed names.
find_program(HELP2MAN help2man REQUIRED)
set(manuals ${PROJECT_BINARY_DIR}/manuals)
file(MAKE_DIRECTORY ${manuals})
file(GLOB script_modules CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/scripts/modules/*.py)

function(add_manual name purpose program)
  add_custom_command(OUTPUT ${manuals}/${name}.1.gz
    COMMAND ${CMAKE_COMMAND} -E env RICOCHET_BIN=${CMAKE_RUNTIME_OUTPUT_DIRECTORY} OMPI_MCA_btl=self
      ${HELP2MAN} --locale C.UTF-8 --no-info --name ${purpose} --output ${manuals}/${name}.1 ${program}
    COMMAND sed -i -e "/^[.]IP$/a.nf" -e "/^[.]IP$/,/^[.][STP]/{/^[.][STP]/i.fi" -e "}" ${manuals}/${name}.1  # examples line by line
    COMMAND gzip -9nf ${manuals}/${name}.1
    DEPENDS ${program} ricochet-contact ${ARGN} VERBATIM)
  set_property(GLOBAL APPEND PROPERTY ricochet_manuals ${manuals}/${name}.1.gz)
endfunction()
function(add_script_manual command purpose)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/scripts/${command} ${manuals}/ricochet-${command} SYMBOLIC)
  add_manual(ricochet-${command} ${purpose} ${manuals}/ricochet-${command} ${PROJECT_SOURCE_DIR}/scripts/${command} ${script_modules})
endfunction()

if(RICOCHET_PREPROCESSOR)
  add_manual(ricochet-kernel "computes kernels of elastic bodies" ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/ricochet-kernel)
endif()
add_manual(ricochet-contact "computes an impact from kernels" ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/ricochet-contact)
add_manual(ricochet-recast "rescales and cuts a kernel" ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/ricochet-recast)
add_script_manual(run "takes a scene from mesh to pictures")
add_script_manual(plot "draws a result")
add_script_manual(report "makes a page of a run")
add_script_manual(sweep "runs a study of many impacts")
add_script_manual(tradeoff "says what the settings of a scene cost and err")
add_script_manual(batch "runs a study on a SLURM cluster")
add_script_manual(import "makes a body from matrices of another program")
add_script_manual(faust "writes a Faust model of a body")
add_script_manual(surfaces "tells the surfaces of a drawing apart")

get_property(pages GLOBAL PROPERTY ricochet_manuals)
add_custom_target(manuals ALL DEPENDS ${pages})
install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT programs)
