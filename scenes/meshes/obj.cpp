#include "scenes/meshes/obj.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "modules/config/error.h"
#include "modules/config/quotation.h"
#include "modules/config/words.h"

namespace rtusim {
namespace {

class obj_parser {
 public:
  obj_parser(std::string_view text, const std::string& place) : place_(place), words_(text, place, word_reader::syntax::obj) {}

  polygons parse() {
    do {
      const std::string_view keyword = words_.in_line();
      if (keyword == "v") vertex();
      if (keyword == "f" || keyword == "fo") face();
      constexpr std::string_view lost[] = {"curv", "surf", "call", "csh"};
      if (std::find(std::begin(lost), std::end(lost), keyword) != std::end(lost))
        throw input_error(words_.here(), quotation(keyword), "an OBJ of polygons, in one file");
    } while (words_.next_line());
    if (greatest_ > static_cast<std::int64_t>(polygons_.vertices.size())) throw no_vertex(greatest_here_, greatest_);
    return std::move(polygons_);
  }

 private:
  void vertex() {
    constexpr const char* expected = "a vertex of three finite numbers";
    constexpr int most_more = 4;
    glm::dvec3& v = polygons_.vertices.emplace_back();
    for (int axis = 0; axis < 3; ++axis) v[axis] = words_.coordinate(words_.in_line(), expected);
    int more = 0;
    for (std::string_view word = words_.in_line(); !word.empty(); word = words_.in_line())
      if (++more > most_more || !number_in<double>(word))
        throw input_error(words_.here(), fmt::format("{} after a vertex", quotation(word)), "a weight or a colour, four numbers at most");
  }
  void face() {
    corners_.clear();
    for (std::string_view word = words_.in_line(); !word.empty(); word = words_.in_line()) corners_.push_back(corner(word));
    if (corners_.size() < 3) throw input_error(words_.here(), fmt::format("a face of {} corners", corners_.size()), "three or more");
    polygons_.add(corners_);
  }
  std::uint32_t corner(std::string_view word) {
    const auto so_far = static_cast<std::int64_t>(polygons_.vertices.size());
    const std::string_view first = word.substr(0, word.find('/'));
    const auto index = number_in<std::int64_t>(first);
    if (!index || !are_others_sound(word.substr(first.size())))
      throw input_error(words_.here(), fmt::format("the corner {}", quotation(word)), "the number of a vertex, as v, v/t, v//n or v/t/n");
    if (*index == 0 || *index < -so_far || *index > most_vertices) throw no_vertex(words_.here(), *index);
    if (*index < 0) return static_cast<std::uint32_t>(so_far + *index);
    // Faces may come before their vertices.
    if (*index > so_far && *index > greatest_) {
      greatest_ = *index;
      greatest_here_ = words_.here();
    }
    return static_cast<std::uint32_t>(*index - 1);
  }
  // The rest of a corner: nothing, or one slash or two, each with a whole number or nothing after it.
  static bool are_others_sound(std::string_view rest) {
    for (int n = 0; n < 2 && !rest.empty(); ++n) {
      rest.remove_prefix(1);
      const std::string_view word = rest.substr(0, rest.find('/'));
      if (!word.empty() && !number_in<std::int64_t>(word)) return false;
      rest.remove_prefix(word.size());
    }
    return rest.empty();
  }
  input_error no_vertex(const std::string& here, std::int64_t index) const {
    return {here, fmt::format("vertex {}", index),
            fmt::format("one of the {} vertices {}", polygons_.vertices.size(), index > 0 ? "of the file" : "before it")};
  }

  static constexpr std::int64_t most_vertices = 0xffffffff;

  const std::string& place_;
  word_reader words_;
  polygons polygons_;
  std::vector<std::uint32_t> corners_;
  std::int64_t greatest_ = 0;  // of the vertices that were not there when they were named
  std::string greatest_here_;
};

}  // namespace

polygons parse_obj(std::string_view text, const std::string& place) { return obj_parser(without_mark(text), place).parse(); }

}  // namespace rtusim
