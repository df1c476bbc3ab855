# SPDX-License-Identifier: GPL-3.0-or-later
# Manual page and completions, made by the PROGRAM itself, in the folder PAGES.
function(page name)
  execute_process(COMMAND ${PROGRAM} ${ARGN} OUTPUT_FILE ${PAGES}/${name} RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "${PROGRAM} ${ARGN} failed")
  endif()
endfunction()
file(MAKE_DIRECTORY ${PAGES})
foreach(shell bash zsh fish)
  page(swath.${shell} completion ${shell})
endforeach()
page(swath.1 man)
# Without the time in its header: two builds give the same bytes.
execute_process(COMMAND gzip -9 -n -f ${PAGES}/swath.1 RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "gzip failed")
endif()
