#include "scenes/meshes/ply.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "modules/config/error.h"
#include "modules/config/quotation.h"
#include "modules/config/words.h"
#include "scenes/meshes/binary.h"

namespace rtusim {
namespace {

enum class value_type : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct type_names {
  value_type type;
  std::string_view name, other_name;
  std::size_t bytes;
  bool whole;
};
constexpr type_names types[] = {{value_type::int8, "char", "int8", 1, true},         {value_type::uint8, "uchar", "uint8", 1, true},
                                {value_type::int16, "short", "int16", 2, true},      {value_type::uint16, "ushort", "uint16", 2, true},
                                {value_type::int32, "int", "int32", 4, true},        {value_type::uint32, "uint", "uint32", 4, true},
                                {value_type::float32, "float", "float32", 4, false}, {value_type::float64, "double", "float64", 8, false}};

const type_names& type_of(std::string_view word, const std::string& here) {
  for (const type_names& t : types)
    if (word == t.name || word == t.other_name) return t;
  throw input_error(here, fmt::format("the type {}", quotation(word)), "a PLY type, such as float, uchar or int");
}

struct property {
  std::string name;
  const type_names* count = nullptr;  // of a list; of a single value there is none
  const type_names* value = nullptr;
};
struct element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<property> properties;
};
enum class encoding : std::uint8_t { text, little_endian, big_endian };
struct header {
  std::optional<encoding> format;
  std::vector<element> elements;
};

// --- the header ---

class header_parser {
 public:
  header_parser(std::string_view bytes, const std::string& place) : bytes_(bytes), place_(place) {
    // How the first line ends tells how all do: after the last, a byte that looks like a line's end is the first of the data.
    const std::size_t end = std::min(bytes.find_first_of("\r\n"), bytes.size());
    end_ = bytes.substr(end, 1) == "\r" && bytes.substr(end, 2) != "\r\n" ? '\r' : '\n';
  }

  header parse() {
    std::string_view line = next_line();
    if (take_word(line) != "ply" || !line.empty()) throw input_error(here(), "another first line", "the word ply");
    header h;
    for (;;) {
      if (at_ == bytes_.size()) throw input_error(fmt::format("{}:{}", place_, line_ + 1), "the end of the file", "end_header");
      line = next_line();
      const std::string whole = quotation(line);
      const std::string_view keyword = take_word(line);
      if (keyword == "comment" || keyword == "obj_info") continue;
      if (keyword == "format")
        format(h, line);
      else if (keyword == "element")
        new_element(h, line);
      else if (keyword == "property")
        new_property(h, line);
      else if (keyword != "end_header")
        throw input_error(here(), quotation(keyword), "format, element, property, comment or end_header");
      if (!line.empty()) throw input_error(here(), fmt::format("the header line {}", whole), "nothing more on it");
      if (keyword == "end_header") break;
    }
    if (!h.format) throw input_error(place_, "a PLY header without a format", "format ascii 1.0 or a binary one");
    return h;
  }
  std::size_t size() const { return at_; }
  std::uint64_t lines() const { return line_; }

 private:
  // The next line without its end and the blanks before that.
  std::string_view next_line() {
    std::string_view line = bytes_.substr(at_, bytes_.find(end_, at_) - at_);
    at_ = std::min(at_ + line.size() + 1, bytes_.size());
    ++line_;
    return line.substr(0, line.find_last_not_of(blanks) + 1);
  }
  // Takes a word, and the blanks after it.
  static std::string_view take_word(std::string_view& line) {
    line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
    const std::string_view word = line.substr(0, line.find_first_of(blanks));
    line.remove_prefix(word.size());
    line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
    return word;
  }
  void format(header& h, std::string_view& line) const {
    const std::string_view name = take_word(line);
    if (name == "ascii")
      h.format = encoding::text;
    else if (name == "binary_little_endian")
      h.format = encoding::little_endian;
    else if (name == "binary_big_endian")
      h.format = encoding::big_endian;
    else
      throw input_error(here(), fmt::format("the format {}", quotation(name)), "ascii, binary_little_endian or binary_big_endian");
    if (const std::string_view version = take_word(line); version != "1.0")
      throw input_error(here(), fmt::format("the version {}", quotation(version)), "1.0");
  }
  void new_element(header& h, std::string_view& line) const {
    element e;
    e.name = std::string(take_word(line));
    const auto is_same = [&](const element& other) { return other.name == e.name; };
    if (std::any_of(h.elements.begin(), h.elements.end(), is_same))
      throw input_error(here(), fmt::format("elements {} again", quotation(e.name)), "each once");
    const std::string_view word = take_word(line);
    const auto count = number_in<std::uint64_t>(word);
    if (!count) throw input_error(here(), fmt::format("the number of elements {}", quotation(word)), "a whole number");
    e.count = *count;
    h.elements.push_back(std::move(e));
  }
  void new_property(header& h, std::string_view& line) const {
    if (h.elements.empty()) throw input_error(here(), "a property", "an element before it");
    property p;
    std::string_view type = take_word(line);
    if (type == "list") {
      p.count = &type_of(take_word(line), here());
      if (!p.count->whole) throw input_error(here(), "a list whose length is no whole number", "an integer type");
      type = take_word(line);
    }
    p.value = &type_of(type, here());
    p.name = std::string(take_word(line));
    if (p.name.empty()) throw input_error(here(), "a property without a name", "one");
    h.elements.back().properties.push_back(std::move(p));
  }
  std::string here() const { return fmt::format("{}:{}", place_, line_); }

  static constexpr std::string_view blanks = " \t\r\n\v\f";
  std::string_view bytes_;
  const std::string& place_;
  char end_;
  std::size_t at_ = 0;
  std::uint64_t line_ = 0;
};

// --- where the values come from; both give them in turn, element by element ---

class text_values {
 public:
  text_values(std::string_view text, const std::string& place, std::uint64_t lines_before)
      : words_(text, place, word_reader::syntax::plain, lines_before + 1) {}

  // False when no element is left.
  bool begin(const element& e) {
    element_ = &e;
    first_ = words_.anywhere();
    return !first_.empty();
  }
  void end() {
    if (const std::string_view word = words_.in_line(); !word.empty())
      throw input_error(words_.here(), fmt::format("{} after an element \"{}\"", quotation(word), element_->name), "the end of the line");
  }
  double coordinate(const type_names&) { return words_.coordinate(next("another number"), "a finite number"); }
  std::int64_t whole(const type_names&) {
    const std::string_view word = next("another number");
    if (const auto value = number_in<std::int64_t>(word)) return *value;
    throw input_error(words_.here(), quotation(word), "a whole number");
  }
  std::uint64_t count(const type_names&) {
    const std::string_view word = next("the length of a list");
    if (const auto value = number_in<std::uint64_t>(word)) return *value;
    throw input_error(words_.here(), fmt::format("the length of a list {}", quotation(word)), "a whole number");
  }
  void skip(const type_names&, std::uint64_t values) {
    for (; values != 0; --values) next("another number");
  }
  std::string rest() {
    const std::string_view word = words_.anywhere();
    return word.empty() ? std::string() : quotation(word);
  }

 private:
  std::string_view next(const char* what) {
    const std::string_view word = first_.empty() ? words_.in_line() : std::exchange(first_, std::string_view());
    if (word.empty()) throw input_error(words_.here(), fmt::format("an element \"{}\" cut short", element_->name), what);
    return word;
  }

  word_reader words_;
  const element* element_ = nullptr;
  std::string_view first_;  // word of the element
};

struct cut_short {};  // a binary element that is not all there

class binary_values {
 public:
  binary_values(std::string_view bytes, const std::string& place, bool big_endian)
      : bytes_(bytes), place_(place), big_endian_(big_endian) {}

  bool begin(const element& e) {
    element_ = &e;
    return !bytes_.empty();
  }
  void end() {}
  double coordinate(const type_names& t) {
    if (t.type == value_type::float32) return double{take<float>()};
    if (t.type == value_type::float64) return take<double>();
    return static_cast<double>(whole(t));
  }
  std::int64_t whole(const type_names& t) {
    switch (t.type) {
      case value_type::int8: return take<std::int8_t>();
      case value_type::uint8: return take<std::uint8_t>();
      case value_type::int16: return take<std::int16_t>();
      case value_type::uint16: return take<std::uint16_t>();
      case value_type::int32: return take<std::int32_t>();
      case value_type::uint32: return take<std::uint32_t>();
      case value_type::float32:
      case value_type::float64: break;
    }
    throw simulation_error("a real number where a whole one was asked for");
  }
  std::uint64_t count(const type_names& t) {
    const std::int64_t value = whole(t);
    if (value < 0) throw input_error(place_, fmt::format("a list of negative length in an element \"{}\"", element_->name), "0 or more");
    return static_cast<std::uint64_t>(value);
  }
  void skip(const type_names& t, std::uint64_t values) {
    if (values > bytes_.size() / t.bytes) throw cut_short();
    bytes_.remove_prefix(static_cast<std::size_t>(values) * t.bytes);
  }
  std::string rest() const {
    return bytes_.find_first_not_of(" \t\r\n") == bytes_.npos ? std::string() : fmt::format("{} bytes", bytes_.size());
  }

 private:
  template <class Value>
  Value take() {
    if (bytes_.size() < sizeof(Value)) throw cut_short();
    const auto value = binary_value<Value>(bytes_, 0, big_endian_);
    bytes_.remove_prefix(sizeof(Value));
    return value;
  }

  std::string_view bytes_;
  const std::string& place_;
  bool big_endian_;
  const element* element_ = nullptr;
};

// --- the body ---

template <class Values>
class body_parser {
 public:
  body_parser(Values values, const std::string& place) : values_(std::move(values)), place_(place) {}

  polygons parse(const header& h) {
    for (const element& e : h.elements) {
      if (e.properties.empty() && e.count != 0)
        throw input_error(place_, fmt::format("{} elements \"{}\" without properties", e.count, e.name), "at least one property");
      if (e.name == "vertex")
        vertices(e);
      else if (e.name == "face")
        faces(e, [this] { face(); });
      else if (e.name == "tristrips")
        faces(e, [this] { strips(); });
      else
        each(e, [&] { skip(e.properties.begin(), e.properties.end()); });
    }
    if (const std::string rest = values_.rest(); !rest.empty())
      throw input_error(place_, fmt::format("{} after the last element", rest), "as many elements as the header claims");
    if (!has_vertices_) throw input_error(place_, "a PLY without elements \"vertex\"", "vertices and faces");
    check_corners();
    return std::move(polygons_);
  }

 private:
  using property_place = std::vector<property>::const_iterator;

  template <class Read>
  void each(const element& e, Read&& read) {
    for (std::uint64_t n = 0; n < e.count; ++n) {
      try {
        if (!values_.begin(e)) throw cut_short();
        read();
        values_.end();
      } catch (const cut_short&) {
        throw input_error(place_, fmt::format("{} of {} elements \"{}\"", n, e.count, e.name), "as many as the header claims");
      }
    }
  }
  void skip(property_place from, property_place to) {
    for (; from != to; ++from) values_.skip(*from->value, from->count != nullptr ? values_.count(*from->count) : 1);
  }
  property_place find(const element& e, std::string_view name, std::string_view other_name, bool list) const {
    const auto is_named = [&](const property& p) { return p.name == name || p.name == other_name; };
    const auto found = std::find_if(e.properties.begin(), e.properties.end(), is_named);
    if (found == e.properties.end() || (found->count != nullptr) != list || (list && !found->value->whole))
      throw input_error(place_, fmt::format("elements \"{}\" without {} {}", e.name, list ? "a list of whole numbers" : "a number", name),
                        "one");
    if (std::find_if(found + 1, e.properties.end(), is_named) != e.properties.end())
      throw input_error(place_, fmt::format("elements \"{}\" with {} twice", e.name, name), "it once");
    return found;
  }

  void vertices(const element& e) {
    has_vertices_ = true;
    if (e.count == 0) return;
    constexpr std::string_view names[] = {"x", "y", "z"};
    std::vector<int> axis(e.properties.size(), -1);
    for (int k = 0; k < 3; ++k) axis[static_cast<std::size_t>(find(e, names[k], names[k], false) - e.properties.begin())] = k;
    each(e, [&] {
      glm::dvec3& v = polygons_.vertices.emplace_back();
      for (auto p = e.properties.begin(); p != e.properties.end(); ++p) {
        const int k = axis[static_cast<std::size_t>(p - e.properties.begin())];
        if (k < 0)
          skip(p, p + 1);
        else
          v[k] = values_.coordinate(*p->value);
      }
    });
  }
  // `take` makes faces of one element's list.
  template <class Take>
  void faces(const element& e, Take&& take) {
    if (e.count == 0) return;
    const auto list = find(e, "vertex_indices", "vertex_index", true);
    each(e, [&] {
      skip(e.properties.begin(), list);
      const std::uint64_t count = values_.count(*list->count);
      corners_.clear();
      for (std::uint64_t k = 0; k < count; ++k) corners_.push_back(values_.whole(*list->value));
      skip(list + 1, e.properties.end());
      take();
    });
  }
  void face() {
    face_.clear();
    for (const std::int64_t c : corners_) face_.push_back(index(c));
    polygons_.add(face_);
  }
  void strips() {
    std::size_t first = 0;  // of the strip
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      if (corners_[k] == -1) {
        first = k + 1;
        continue;
      }
      const std::uint32_t last = index(corners_[k]);
      if (k < first + 2) continue;
      const std::uint32_t a = index(corners_[k - 2]), b = index(corners_[k - 1]);
      polygons_.add((k - first) % 2 == 0 ? std::array<std::uint32_t, 3>{a, b, last} : std::array<std::uint32_t, 3>{b, a, last});
    }
  }
  // Vertices may come after faces: whether it is there is seen at the end.
  std::uint32_t index(std::int64_t corner) const {
    if (corner < 0 || corner >= ~std::uint32_t{0}) throw no_vertex(polygons_.sizes.size(), corner);
    return static_cast<std::uint32_t>(corner);
  }
  void check_corners() const {
    auto corner = polygons_.corners.begin();
    for (std::size_t f = 0; f < polygons_.sizes.size(); ++f)
      for (std::uint32_t k = 0; k < polygons_.sizes[f]; ++k, ++corner)
        if (*corner >= polygons_.vertices.size()) throw no_vertex(f, *corner);
  }
  input_error no_vertex(std::size_t face, std::int64_t corner) const {
    return {place_, fmt::format("face {} has vertex {}", face, corner),
            polygons_.vertices.empty() ? "one of the vertices" : fmt::format("one of the {} vertices", polygons_.vertices.size())};
  }

  Values values_;
  const std::string& place_;
  polygons polygons_;
  bool has_vertices_ = false;
  std::vector<std::int64_t> corners_;  // of the element's list
  std::vector<std::uint32_t> face_;
};

}  // namespace

polygons parse_ply(std::string_view bytes, const std::string& place) {
  bytes = without_mark(bytes);
  header_parser parser(bytes, place);
  const header h = parser.parse();
  bytes.remove_prefix(parser.size());
  if (*h.format == encoding::text) return body_parser(text_values(bytes, place, parser.lines()), place).parse(h);
  return body_parser(binary_values(bytes, place, *h.format == encoding::big_endian), place).parse(h);
}

}  // namespace rtusim
