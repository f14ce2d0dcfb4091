#include "scenes/meshes/stl.h"

#include <array>
#include <cstdint>

#include "modules/config/error.h"
#include "modules/config/quotation.h"
#include "modules/config/words.h"
#include "scenes/meshes/binary.h"

namespace rtusim {
namespace {

constexpr std::size_t header_bytes = 80, count_bytes = 4, triangle_bytes = 50, normal_bytes = 12, vertex_bytes = 12;

void add_facet(polygons& p) {
  const auto past = static_cast<std::uint32_t>(p.vertices.size());
  p.add(std::array<std::uint32_t, 3>{past - 3, past - 2, past - 1});
}

polygons parse_binary(std::string_view bytes, std::size_t triangles) {
  polygons p;
  p.vertices.reserve(3 * triangles);
  for (std::size_t n = 0; n < triangles; ++n) {
    std::size_t at = header_bytes + count_bytes + n * triangle_bytes + normal_bytes;
    for (int k = 0; k < 3; ++k, at += vertex_bytes) {
      const auto coordinate = [&](std::size_t i) { return double{binary_value<float>(bytes, at + 4 * i, false)}; };
      p.vertices.emplace_back(coordinate(0), coordinate(1), coordinate(2));
    }
    add_facet(p);
  }
  return p;
}

class text_parser {
 public:
  text_parser(std::string_view text, const std::string& place) : words_(text, place) {}

  polygons parse() {
    for (std::string_view word = words_.anywhere(); !word.empty(); word = words_.anywhere()) {
      check(word, "solid");
      words_.next_line();  // the rest is a name
      solid();
    }
    return std::move(polygons_);
  }

 private:
  void solid() {
    for (;;) {
      const std::string_view word = words_.anywhere();
      if (is_word(word, "endsolid")) break;
      check(word, "facet", "facet or endsolid");
      facet();
    }
    words_.next_line();
  }
  void facet() {
    expect("normal");
    for (int k = 0; k < 3; ++k)
      if (words_.in_line().empty()) throw input_error(words_.here(), "the end of the line", "a normal of three numbers");
    expect("outer");
    expect("loop");
    for (int k = 0; k < 3; ++k) {
      expect("vertex");
      glm::dvec3& v = polygons_.vertices.emplace_back();
      for (int axis = 0; axis < 3; ++axis) v[axis] = words_.coordinate(words_.in_line(), "a vertex of three finite numbers");
    }
    expect("endloop", "endloop, after three vertices");
    expect("endfacet");
    add_facet(polygons_);
  }
  void expect(const char* keyword, const char* expected = nullptr) { check(words_.anywhere(), keyword, expected); }
  void check(std::string_view word, const char* keyword, const char* expected = nullptr) const {
    if (!is_word(word, keyword))
      throw input_error(words_.here(), word.empty() ? "the end of the file" : quotation(word), expected != nullptr ? expected : keyword);
  }

  word_reader words_;
  polygons polygons_;
};

}  // namespace

polygons parse_stl(std::string_view bytes, const std::string& place) {
  const bool has_count = bytes.size() >= header_bytes + count_bytes;
  const std::uint64_t triangles = has_count ? binary_value<std::uint32_t>(bytes, header_bytes, false) : 0;
  const std::uint64_t binary_bytes = header_bytes + count_bytes + triangles * triangle_bytes;
  if (has_count && bytes.size() == binary_bytes) return parse_binary(bytes, static_cast<std::size_t>(triangles));

  const std::string_view text = without_mark(bytes);
  if (is_word(word_reader(text, place).anywhere(), "solid") && text.find('\0') == text.npos) return text_parser(text, place).parse();
  throw input_error(place, fmt::format("{} bytes", bytes.size()),
                    has_count ? fmt::format("{}, for the {} triangles claimed", binary_bytes, triangles)
                              : "an STL, at least 84 bytes or text that begins with solid");
}

}  // namespace rtusim
