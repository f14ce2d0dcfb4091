#include <catch2/catch.hpp>

#include <string>

#include "modules/config/printable.h"

namespace rtusim::config {

TEST_CASE("printable: letters of all scripts stay, controls and broken bytes do not") {
  const struct {
    std::string text, shown;
  } table[] = {
      {"", ""},
      {"a model.svo", "a model.svo"},
      {"Asbj\u00f8rn \u00df \u65e5\u672c \U0001f409", "Asbj\u00f8rn \u00df \u65e5\u672c \U0001f409"},
      {"a\x1b[31mb\n\r\t\x7f", "a?[31mb????"},
      {std::string("a\0b", 3), "a?b"},
      {"\xc2\x9b"
       "31m",
       "??31m"},  // a control character of Latin-1, which terminals obey
      {"\xe2\x80\xae"
       "gpj.exe",
       "???gpj.exe"},           // turns what follows
      {"\xe2\x80\xa8", "???"},  // ends a line
      {"\xff\xfe", "??"},
      {"\xc3", "?"},  // cut short
      {"\xe2\x82", "??"},
      {"\xc3"
       "a",
       "?a"},
      {"\x80", "?"},
      {"\xc0\xaf", "??"},  // overlong
      {"\xe0\x80\xaf", "???"},
      {"\xed\xa0\x80", "???"},       // half of a surrogate pair
      {"\xf4\x90\x80\x80", "????"},  // beyond the last character
      {"\xf0\x9f\x90\x89", "\xf0\x9f\x90\x89"},
  };
  for (const auto& row : table) {
    CHECK(printable(row.text) == row.shown);
    // What lies around a text stays, whatever it is.
    std::string among = '\x01' + row.text + "\x02\xc3";
    make_printable(among.data() + 1, row.text.size());
    CHECK(among == '\x01' + row.shown + "\x02\xc3");
  }
}

}  // namespace rtusim::config
