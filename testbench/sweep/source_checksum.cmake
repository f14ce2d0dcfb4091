# Writes OUTPUT, the C++ source of rtusim::source_checksum for the sources below ROOT; leaves it alone when nothing changed.
file(GLOB_RECURSE files RELATIVE ${ROOT}
  ${ROOT}/modules/*.h ${ROOT}/modules/*.cpp ${ROOT}/scenes/*.h ${ROOT}/scenes/*.cpp ${ROOT}/testbench/*.h ${ROOT}/testbench/*.cpp)
list(FILTER files EXCLUDE REGEX "^testbench/(tests|benchmarks)/")
list(SORT files)
set(all "")
foreach(file IN LISTS files)
  file(SHA256 ${ROOT}/${file} checksum)
  string(APPEND all "${checksum} ${file}\n")
endforeach()
string(SHA256 checksum "${all}")
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
#include "testbench/sweep/source_checksum.h"

std::string_view rtusim::source_checksum() { return "@checksum@"; }
]])
