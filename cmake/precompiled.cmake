# Headers of others that most sources include, read once a build: a quarter of its time. `-DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON` (the debug
# preset) builds without, which tells when a source lacks an include of its own.

# A target for `target_precompile_headers(... REUSE_FROM TARGET)`, of these headers and those that follow LIBRARY's name.
function(precompile target library)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/${target}.cpp CONTENT "")
  add_library(${target} OBJECT ${PROJECT_BINARY_DIR}/${target}.cpp)
  target_link_libraries(${target} PRIVATE rtusim_options ${library} fmt::fmt nlohmann_json::nlohmann_json PkgConfig::systemc)
  target_precompile_headers(${target} PRIVATE ${ARGN} <algorithm> <array> <filesystem> <functional> <map> <memory> <optional> <sstream>
    <string> <variant> <vector> <fmt/format.h> <nlohmann/json.hpp> <systemc>)
endfunction()
