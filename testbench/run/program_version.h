#pragma once

#include <string_view>

namespace rtusim {

/// The version and the commit that this program was built from, "0.1.0 (06ecbb0)": with "+" after the commit if the sources differed from
/// it, and with "unknown" in its place where git knew none.
std::string_view program_version();

}  // namespace rtusim
