#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace rtusim::config {

/// Makes a text fit for a terminal, in its place: a question mark for each byte of a control character, of what turns the direction of
/// writing, and of what is no UTF-8.
void make_printable(char* text, std::size_t bytes) noexcept;

/// The same of a copy: for names of files, and whatever else a user or a file says, before they are shown.
std::string printable(std::string_view text);

}  // namespace rtusim::config
