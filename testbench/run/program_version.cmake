# Writes OUTPUT, the C++ source of rtusim::program_version for VERSION and the tree ROOT; leaves it alone when nothing changed.
function(git output)
  execute_process(COMMAND git -C ${ROOT} --no-optional-locks ${ARGN}
    OUTPUT_VARIABLE text RESULT_VARIABLE status ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT status EQUAL 0)
    set(text "")
  endif()
  set(${output} "${text}" PARENT_SCOPE)
endfunction()

# A copy of the sources may lie in another project's tree.
file(REAL_PATH ${ROOT} root)
git(top rev-parse --show-toplevel)
set(commit "")
if(top STREQUAL root)
  git(commit rev-parse --short HEAD)
  git(changes status --porcelain --untracked-files=no)
endif()
if(commit STREQUAL "")
  set(commit unknown)
elseif(NOT changes STREQUAL "")
  string(APPEND commit "+")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
#include "testbench/run/program_version.h"

std::string_view rtusim::program_version() { return "@VERSION@ (@commit@)"; }
]])
