#include "scenes/mesh_file_checks.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <system_error>
#include <type_traits>
#include <vector>

#include "modules/config/error.h"
#include "scenes/quotation.h"

namespace rtusim {
namespace {

// Takes the first word off a text; empty when none is left.
std::string_view take_word(std::string_view& text) {
  constexpr std::string_view blanks = " \t\r\n\v\f";
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(blanks));
  text.remove_prefix(word.size());
  return word;
}

// Takes the first line off a text, without its end.
std::string_view take_line(std::string_view& text) {
  std::string_view line = text.substr(0, text.find('\n'));
  text.remove_prefix(std::min(line.size() + 1, text.size()));
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

template <class Number>
std::optional<Number> number(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  Number value{};
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (status == std::errc::invalid_argument || end != word.data() + word.size()) return std::nullopt;
  if (status != std::errc{} && std::is_integral_v<Number>) return std::nullopt;
  return value;
}

std::string line_place(const std::string& place, std::uint64_t line) { return fmt::format("{}:{}", place, line); }

// --- PLY ---

struct ply_property {
  unsigned count_bytes = 0;   // of a list's length; 0 for a single value
  bool count_signed = false;
  unsigned value_bytes = 0;
};
struct ply_element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<ply_property> properties;
};
enum class ply_encoding : std::uint8_t { text, little_endian, big_endian };
struct ply_header {
  ply_encoding encoding = ply_encoding::text;
  std::vector<ply_element> elements;
};

struct ply_type { std::string_view name, other_name; unsigned bytes; bool is_integer, is_signed; };
constexpr ply_type ply_types[] = {
    {"char", "int8", 1, true, true},    {"uchar", "uint8", 1, true, false}, {"short", "int16", 2, true, true},
    {"ushort", "uint16", 2, true, false}, {"int", "int32", 4, true, true},  {"uint", "uint32", 4, true, false},
    {"float", "float32", 4, false, true}, {"double", "float64", 8, false, true}};

const ply_type& type_of(std::string_view word, const std::string& place) {
  for (const ply_type& t : ply_types)
    if (word == t.name || word == t.other_name) return t;
  throw input_error(place, fmt::format("the type {}", quotation(word)), "a PLY type, such as float, uchar or int");
}

// Takes the header off the bytes; counts its lines.
ply_header take_ply_header(std::string_view& bytes, const std::string& place, std::uint64_t& line_number) {
  line_number = 1;
  if (take_line(bytes) != "ply") throw input_error(line_place(place, 1), "another first line", "the word ply");
  ply_header header;
  bool formatted = false;
  for (;;) {
    ++line_number;
    const std::string here = line_place(place, line_number);
    if (bytes.empty()) throw input_error(here, "the end of the file", "end_header");
    std::string_view line = take_line(bytes);
    // The importer waits for ever for an end_header that it does not recognise.
    if (line == "end_header") break;
    const auto is_control = [](unsigned char c) { return c < ' ' && c != '\t'; };
    const auto is_foreign = [](unsigned char c) { return c > '~'; };
    const bool garbled = std::any_of(line.begin(), line.end(), is_control);
    const bool ascii = std::none_of(line.begin(), line.end(), is_foreign);
    const std::string whole = quotation(line);
    const std::string_view keyword = take_word(line);
    const bool remark = keyword == "comment" || keyword == "obj_info";
    if (garbled || (!ascii && !remark)) throw input_error(here, fmt::format("the header line {}", whole), "plain text");
    if (remark) continue;
    if (keyword == "format") {
      const std::string_view format = take_word(line);
      if (format == "ascii") header.encoding = ply_encoding::text;
      else if (format == "binary_little_endian") header.encoding = ply_encoding::little_endian;
      else if (format == "binary_big_endian") header.encoding = ply_encoding::big_endian;
      else throw input_error(here, fmt::format("the format {}", quotation(format)), "ascii, binary_little_endian or binary_big_endian");
      formatted = true;
    } else if (keyword == "element") {
      ply_element& element = header.elements.emplace_back();
      element.name = std::string(take_word(line));
      const std::string_view word = take_word(line);
      const auto count = number<std::uint64_t>(word);
      if (!count) throw input_error(here, fmt::format("the number of elements {}", quotation(word)), "a whole number");
      element.count = *count;
    } else if (keyword == "property") {
      if (header.elements.empty()) throw input_error(here, "a property", "an element before it");
      ply_property property;
      std::string_view type = take_word(line);
      if (type == "list") {
        const ply_type& count = type_of(take_word(line), here);
        if (!count.is_integer) throw input_error(here, "a list whose length is no whole number", "an integer type");
        property.count_bytes = count.bytes;
        property.count_signed = count.is_signed;
        type = take_word(line);
      }
      property.value_bytes = type_of(type, here).bytes;
      header.elements.back().properties.push_back(property);
    } else {
      throw input_error(here, quotation(keyword), "format, element, property, comment or end_header");
    }
  }
  if (!formatted) throw input_error(place, "a PLY header without a format", "format ascii 1.0 or a binary one");
  // The importer takes other elements for faces when they come before them.
  if (header.elements.size() < 2 || header.elements[0].name != "vertex" || header.elements[1].name != "face")
    throw input_error(place, "a PLY header that does not begin with vertices and faces", "element vertex, element face, then any others");
  return header;
}

// Checks the line of one element of a text PLY.
void check_ply_line(std::string_view line, const ply_element& element, const std::string& here) {
  const auto take_value = [&](const char* what) {
    const std::string_view word = take_word(line);
    if (word.empty()) throw input_error(here, fmt::format("an element \"{}\" cut short", element.name), what);
    return word;
  };
  for (const ply_property& p : element.properties) {
    std::uint64_t values = 1;
    if (p.count_bytes != 0) {
      const std::string_view word = take_value("the length of a list");
      const auto count = number<std::uint64_t>(word);
      if (!count) throw input_error(here, fmt::format("the length of a list {}", quotation(word)), "a whole number");
      values = *count;
    }
    for (; values != 0; --values) {
      const std::string_view word = take_value("another number");
      if (!number<double>(word)) throw input_error(here, quotation(word), "a number");
    }
  }
}

// Takes the values of one element off a binary PLY's bytes, false when they are not there.
bool take_ply_bytes(std::string_view& bytes, const ply_element& element, ply_encoding encoding, const std::string& place) {
  for (const ply_property& p : element.properties) {
    std::uint64_t values = 1;
    if (p.count_bytes != 0) {
      if (bytes.size() < p.count_bytes) return false;
      values = 0;
      for (unsigned b = 0; b < p.count_bytes; ++b) {
        const unsigned i = encoding == ply_encoding::big_endian ? b : p.count_bytes - 1 - b;
        values = (values << 8) | static_cast<unsigned char>(bytes[i]);
      }
      if (p.count_signed && (values >> (8 * p.count_bytes - 1)) != 0)
        throw input_error(place, fmt::format("a list of negative length in an element \"{}\"", element.name), "0 or more");
      bytes.remove_prefix(p.count_bytes);
    }
    if (values > bytes.size() / p.value_bytes) return false;
    bytes.remove_prefix(static_cast<std::size_t>(values * p.value_bytes));
  }
  return true;
}

// --- OBJ ---

// Takes a line off an OBJ, joined with those that follow a backslash; counts the lines.
std::string take_joined_line(std::string_view& text, std::uint64_t& lines) {
  std::string joined;
  while (!text.empty()) {
    joined += take_line(text);
    ++lines;
    if (joined.empty() || joined.back() != '\\') break;
    joined.back() = ' ';
  }
  return joined;
}

void check_obj_vertex(std::string_view rest, const std::string& here) {
  for (int k = 0; k < 3; ++k) {
    const std::string_view word = take_word(rest);
    if (!number<double>(word)) throw input_error(here, word.empty() ? "a vertex cut short" : quotation(word), "three numbers");
  }
}

void check_obj_face(std::string_view rest, std::int64_t vertices_before, std::int64_t vertices, const std::string& here) {
  int corners = 0;
  for (std::string_view word = take_word(rest); !word.empty() && word.front() != '#'; word = take_word(rest), ++corners) {
    const auto index = number<std::int64_t>(word.substr(0, word.find('/')));
    if (!index) throw input_error(here, fmt::format("the corner {}", quotation(word)), "the number of a vertex");
    // Negative ones count back from the last vertex so far.
    if (*index == 0 || *index > vertices || *index < -vertices_before)
      throw input_error(here, fmt::format("vertex {}", *index), fmt::format("one of the file's {} vertices", vertices));
  }
  if (corners < 3) throw input_error(here, fmt::format("a face of {} corners", corners), "three or more");
}

}  // namespace

void check_ply(std::string_view bytes, const std::string& place) {
  std::uint64_t line_number = 0;
  const ply_header header = take_ply_header(bytes, place, line_number);
  for (const ply_element& element : header.elements) {
    if (element.properties.empty() && element.count != 0)
      throw input_error(place, fmt::format("{} elements \"{}\" without properties", element.count, element.name), "at least one property");
    for (std::uint64_t n = 0; n < element.count; ++n) {
      bool present = !bytes.empty();
      if (header.encoding != ply_encoding::text)
        present = take_ply_bytes(bytes, element, header.encoding, place);
      else if (present)
        check_ply_line(take_line(bytes), element, line_place(place, ++line_number));
      if (!present)
        throw input_error(place, fmt::format("{} of {} elements \"{}\"", n, element.count, element.name), "as many as the header claims");
    }
  }
}

void check_obj(std::string_view text, const std::string& place) {
  std::int64_t vertices = 0;
  std::uint64_t line_number = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const std::string line = take_joined_line(rest, line_number);
    std::string_view words = line;
    if (take_word(words) != "v") continue;
    check_obj_vertex(words, line_place(place, line_number));
    ++vertices;
  }
  std::int64_t vertices_before = 0;
  line_number = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const std::string line = take_joined_line(rest, line_number);
    std::string_view words = line;
    const std::string_view keyword = take_word(words);
    if (keyword == "v") ++vertices_before;
    if (keyword == "f") check_obj_face(words, vertices_before, vertices, line_place(place, line_number));
  }
}

void check_stl(std::string_view bytes, const std::string& place) {
  constexpr std::size_t header_bytes = 80, count_bytes = 4, triangle_bytes = 50;
  std::uint64_t triangles = 0;
  const bool has_count = bytes.size() >= header_bytes + count_bytes;
  if (has_count)
    for (std::size_t b = count_bytes; b-- > 0;) triangles = (triangles << 8) | static_cast<unsigned char>(bytes[header_bytes + b]);
  const std::uint64_t binary_bytes = header_bytes + count_bytes + triangles * triangle_bytes;
  if (has_count && bytes.size() == binary_bytes) return;

  std::string_view text = bytes;
  if (take_word(text) == "solid") {
    if (bytes.find("endsolid") == std::string_view::npos) throw input_error(place, "a text STL that does not end", "endsolid");
    return;
  }
  if (!has_count) throw input_error(place, fmt::format("{} bytes", bytes.size()),
                                    "an STL, at least 84 bytes or text that begins with solid");
  throw input_error(place, fmt::format("{} bytes", bytes.size()), fmt::format("{}, for the {} triangles claimed", binary_bytes, triangles));
}

}  // namespace rtusim
