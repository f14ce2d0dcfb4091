#include "scenes/meshes/gltf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

#include "modules/config/error.h"
#include "modules/config/json.h"
#include "modules/config/quotation.h"
#include "modules/config/words.h"
#include "scenes/meshes/binary.h"

namespace rtusim {
namespace {

using nlohmann::json;

constexpr unsigned most_node_levels = 256;
constexpr std::uint64_t most_number = 0x7fffffff;
constexpr std::uint64_t most_buffer_bytes = std::uint64_t{1} << 30;
constexpr std::uint64_t most_without_bytes = 1 << 20;  // elements of an accessor that begins as zeros

// --- JSON ---

json parse_json(std::string_view text, const std::string& place) {
  if (config::json_levels(text) > config::most_json_levels)
    throw input_error(place, "deeply nested JSON", fmt::format("at most {} levels", config::most_json_levels));
  try {
    return json::parse(without_mark(text));
  } catch (const json::parse_error& e) {
    throw input_error(place, fmt::format("broken JSON at its byte {}", e.byte), "a glTF");
  } catch (const json::exception&) {
    throw input_error(place, "JSON with a number out of range", "a glTF");
  }
}

std::string shown(const json& value) {
  if (value.is_structured()) return fmt::format("an {}", value.type_name());
  return value.is_string() ? quotation(value.get_ref<const std::string&>()) : value.dump();
}

// An object of the file, whose fields are checked when they are asked for.
class object {
 public:
  object(const json& value, std::string place) : value_(value), place_(std::move(place)) {
    if (!value_.is_object()) throw input_error(place_, shown(value_), "an object");
  }

  bool has(const char* key) const { return value_.contains(key); }
  const std::string& place() const { return place_; }
  std::string place(const char* key) const { return fmt::format("{}: {}", place_, key); }

  std::uint64_t number(const char* key, std::uint64_t least, std::uint64_t most) const { return checked(required(key), least, most, key); }
  std::uint64_t number(const char* key, std::uint64_t least, std::uint64_t most, std::uint64_t otherwise) const {
    return has(key) ? number(key, least, most) : otherwise;
  }
  // Which of `size` things a field names.
  std::size_t index(const char* key, std::size_t size) const {
    required(key);
    if (size == 0) throw input_error(place(key), "a reference", "something that it refers to");
    return static_cast<std::size_t>(number(key, 0, size - 1));
  }
  // Several of them, each once; none without the field.
  std::vector<std::size_t> indices(const char* key, std::size_t size) const {
    std::vector<std::size_t> all;
    for (const json& v : array(key)) {
      if (size == 0) throw input_error(place(key), "a reference", "something that it refers to");
      all.push_back(static_cast<std::size_t>(checked(v, 0, size - 1, key)));
    }
    std::vector<std::size_t> sorted = all;
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) throw input_error(place(key), "an index twice", "each once");
    return all;
  }
  // So many numbers; nothing without the field.
  template <std::size_t count>
  std::optional<std::array<double, count>> reals(const char* key) const {
    if (!has(key)) return std::nullopt;
    const std::vector<double> all = reals(key);
    if (all.size() != count) throw input_error(place(key), fmt::format("{} numbers", all.size()), fmt::format("{}", count));
    std::array<double, count> values{};
    std::copy(all.begin(), all.end(), values.begin());
    return values;
  }
  std::vector<double> reals(const char* key) const {
    std::vector<double> all;
    for (const json& v : array(key)) {
      if (!v.is_number()) throw input_error(place(key), shown(v), "numbers");
      all.push_back(v.get<double>());
    }
    return all;
  }
  const std::string& text(const char* key) const {
    const json& value = required(key);
    if (!value.is_string()) throw input_error(place(key), shown(value), "a text");
    return value.get_ref<const std::string&>();
  }
  // False without the field.
  bool flag(const char* key) const {
    if (!has(key)) return false;
    const json& value = required(key);
    if (!value.is_boolean()) throw input_error(place(key), shown(value), "true or false");
    return value.get<bool>();
  }
  object child(const char* key) const { return {required(key), place(key)}; }
  // One of an array of objects.
  object child(const char* key, std::size_t index) const { return {array(key)[index], fmt::format("{}[{}]", place(key), index)}; }
  // An array's size; 0 without the field.
  std::size_t size(const char* key) const { return array(key).size(); }
  const json& array(const char* key) const {
    static const json none = json::array();
    if (!has(key)) return none;
    const json& value = value_[key];
    if (!value.is_array()) throw input_error(place(key), shown(value), "an array");
    return value;
  }

 private:
  const json& required(const char* key) const {
    const auto found = value_.find(key);
    if (found == value_.end()) throw input_error(place_, fmt::format("no \"{}\"", key), "one");
    return *found;
  }
  std::uint64_t checked(const json& value, std::uint64_t least, std::uint64_t most, const char* key) const {
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() < least || value.get<std::uint64_t>() > most)
      throw input_error(place(key), shown(value), fmt::format("a whole number from {} to {}", least, most));
    return value.get<std::uint64_t>();
  }

  const json& value_;
  std::string place_;
};

// --- URIs ---

int hexadecimal(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

std::string percent_decoded(std::string_view text, const std::string& place) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      bytes.push_back(text[i]);
      continue;
    }
    const int high = text.size() - i > 2 ? hexadecimal(text[i + 1]) : -1, low = high < 0 ? -1 : hexadecimal(text[i + 2]);
    if (low < 0) throw input_error(place, quotation(text.substr(i, 3)), "% and two hexadecimal digits");
    bytes.push_back(static_cast<char>(16 * high + low));
    i += 2;
  }
  return bytes;
}

std::string base64_decoded(std::string_view text, const std::string& place) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t word = 0;
  unsigned bits = 0;
  for (const char c : text) {
    const std::size_t digit = digits.find(c);
    if (digit == digits.npos) throw input_error(place, quotation(std::string_view(&c, 1)), "digits of base64");
    word = (word << 6) | static_cast<std::uint32_t>(digit);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<char>((word >> bits) & 0xff));
  }
  return bytes;
}

// `data:[TYPE][;base64],DATA`
std::string data_of(std::string_view uri, const std::string& place) {
  const std::size_t comma = uri.find(',');
  if (comma == uri.npos) throw input_error(place, quotation(uri), "a comma before the data");
  constexpr std::string_view base64 = ";base64";
  const std::string_view head = uri.substr(0, comma), data = uri.substr(comma + 1);
  const bool is_base64 = head.size() >= base64.size() && head.substr(head.size() - base64.size()) == base64;
  return is_base64 ? base64_decoded(data, place) : percent_decoded(data, place);
}

// Whether a URI begins with a scheme, such as http:.
bool has_scheme(std::string_view uri) {
  const std::size_t colon = uri.find_first_of(":/");
  return colon != uri.npos && uri[colon] == ':';
}

// --- buffers and accessors ---

// All buffers of a file, each read when it is first asked for.
class buffer_store {
 public:
  buffer_store(const object& gltf, std::optional<std::string_view> chunk, const beside_reader& read_beside)
      : gltf_(gltf), chunk_(chunk), read_beside_(read_beside) {}

  std::string_view operator[](std::size_t index) {
    const object buffer = gltf_.child("buffers", index);
    const std::uint64_t size = buffer.number("byteLength", 1, most_number);
    std::string_view bytes;
    if (buffer.has("uri")) {
      const auto [known, fresh] = read_.try_emplace(index);
      if (fresh) known->second = bytes_of(buffer.text("uri"), buffer.place("uri"));
      bytes = known->second;
    } else if (index == 0 && chunk_) {
      bytes = *chunk_;
    } else {
      throw input_error(buffer.place(), "a buffer without a uri", "one, or the first buffer of a .glb that has a binary chunk");
    }
    if (bytes.size() < size)
      throw input_error(buffer.place(), fmt::format("{} bytes", bytes.size()), fmt::format("{}, as its byteLength says", size));
    return bytes.substr(0, static_cast<std::size_t>(size));
  }

 private:
  std::string bytes_of(const std::string& uri, const std::string& place) {
    std::string bytes;
    if (uri.rfind("data:", 0) == 0) {
      bytes = data_of(uri, place);
    } else {
      if (has_scheme(uri)) throw input_error(place, quotation(uri), "data, or a file beside the glTF");
      bytes = read_beside_(percent_decoded(uri, place), left_);
    }
    if (bytes.size() > left_) throw input_error(place, "more bytes in buffers", fmt::format("at most {}", most_buffer_bytes));
    left_ -= bytes.size();
    return bytes;
  }

  const object& gltf_;
  std::optional<std::string_view> chunk_;
  const beside_reader& read_beside_;
  std::map<std::size_t, std::string> read_;
  std::uint64_t left_ = most_buffer_bytes;
};

struct component {
  std::uint64_t code;
  std::size_t bytes;
  double greatest;  // the value that is 1 if normalised
  double (*value)(std::string_view bytes, std::size_t at);
};
template <class Number>
constexpr component component_as(std::uint64_t code, double greatest) {
  return {code, sizeof(Number), greatest,
          [](std::string_view bytes, std::size_t at) { return static_cast<double>(binary_value<Number>(bytes, at, false)); }};
}
constexpr component components[] = {
    component_as<std::int8_t>(5120, 127),     component_as<std::uint8_t>(5121, 255),           component_as<std::int16_t>(5122, 32767),
    component_as<std::uint16_t>(5123, 65535), component_as<std::uint32_t>(5125, 4294967295.0), component_as<float>(5126, 1)};
constexpr std::uint64_t component_float = 5126;

const component& component_of(const object& o) {
  const std::uint64_t code = o.number("componentType", 0, most_number);
  for (const component& c : components)
    if (c.code == code) return c;
  throw input_error(o.place("componentType"), std::to_string(code), "5120, 5121, 5122, 5123, 5125 or 5126");
}

// The elements of an accessor, read when they are asked for.
class accessor {
 public:
  accessor(const object& gltf, std::size_t index, buffer_store& buffers)
      : gltf_(gltf),
        buffers_(buffers),
        own_(gltf.child("accessors", index)),
        component_(component_of(own_)),
        count_(own_.number("count", 1, most_number)),
        type_(own_.text("type")),
        normalised_(own_.flag("normalized") && component_.code != component_float) {
    if (type_ != "SCALAR" && type_ != "VEC3") return;  // which the caller refuses
    size_ = (type_ == "SCALAR" ? 1 : 3) * component_.bytes;
    if (own_.has("bufferView"))
      std::tie(bytes_, stride_) = elements(own_, count_, size_);
    else if (count_ > most_without_bytes)
      throw input_error(own_.place(), fmt::format("{} elements without a bufferView", count_),
                        fmt::format("at most {}", most_without_bytes));
    if (own_.has("sparse")) read_sparse();
  }

  std::uint64_t count() const { return count_; }
  const std::string& type() const { return type_; }
  std::uint64_t component_type() const { return component_.code; }

  // A coordinate of an element, or its only number.
  double value(std::uint64_t element, std::size_t axis = 0) const {
    std::string_view from = bytes_;
    std::size_t at = static_cast<std::size_t>(element) * stride_;
    if (!replaced_.empty()) {
      const auto found = std::lower_bound(replaced_.begin(), replaced_.end(), std::pair<std::uint64_t, std::size_t>(element, 0));
      if (found != replaced_.end() && found->first == element) {
        from = values_;
        at = found->second * size_;
      }
    }
    if (from.empty()) return 0;
    const double v = component_.value(from, at + axis * component_.bytes);
    return normalised_ ? std::max(v / component_.greatest, -1.0) : v;
  }

 private:
  // The bytes from the first of `count` elements on, and how far these are apart. `o` names the view.
  std::pair<std::string_view, std::size_t> elements(const object& o, std::uint64_t count, std::size_t size) {
    const object view = gltf_.child("bufferViews", o.index("bufferView", gltf_.size("bufferViews")));
    const std::string_view buffer = buffers_[view.index("buffer", gltf_.size("buffers"))];
    const std::uint64_t from = view.number("byteOffset", 0, most_number, 0), length = view.number("byteLength", 1, most_number);
    if (from + length > buffer.size())
      throw input_error(view.place(), fmt::format("bytes {} to {}", from, from + length),
                        fmt::format("some of the buffer's {}", buffer.size()));
    const std::uint64_t stride = view.number("byteStride", size, 252, size), offset = o.number("byteOffset", 0, most_number, 0);
    if (const std::uint64_t needed = offset + (count - 1) * stride + size; needed > length)
      throw input_error(o.place(), fmt::format("{} bytes", needed), fmt::format("at most the {} of its bufferView", length));
    return {buffer.substr(static_cast<std::size_t>(from + offset), static_cast<std::size_t>(length - offset)), stride};
  }
  void read_sparse() {
    const object sparse = own_.child("sparse"), indices = sparse.child("indices");
    const std::uint64_t count = sparse.number("count", 1, count_);
    const component& c = component_of(indices);
    if (c.code != 5121 && c.code != 5123 && c.code != 5125)
      throw input_error(indices.place("componentType"), std::to_string(c.code), "5121, 5123 or 5125");
    const auto [bytes, stride] = elements(indices, count, c.bytes);
    values_ = elements(sparse.child("values"), count, size_).first;
    for (std::uint64_t n = 0; n < count; ++n) {
      const auto element = static_cast<std::uint64_t>(c.value(bytes, static_cast<std::size_t>(n) * stride));
      if (element >= count_ || (!replaced_.empty() && element <= replaced_.back().first))
        throw input_error(indices.place(), fmt::format("element {}", element), fmt::format("rising ones below {}", count_));
      replaced_.emplace_back(element, static_cast<std::size_t>(n));
    }
  }

  const object& gltf_;
  buffer_store& buffers_;
  object own_;
  const component& component_;
  std::uint64_t count_;
  std::string type_;
  bool normalised_;
  std::size_t size_ = 0, stride_ = 0;
  std::string_view bytes_;                                       // from the first element on; none if all begin as 0
  std::string_view values_;                                      // of the elements replaced
  std::vector<std::pair<std::uint64_t, std::size_t>> replaced_;  // which, in their order, and by which value
};

// --- the scene ---

class gltf_parser {
 public:
  gltf_parser(const json& document, std::optional<std::string_view> chunk, const std::string& place, std::uint64_t most_faces,
              const beside_reader& read_beside)
      : gltf_(document, place), buffers_(gltf_, chunk, read_beside), most_faces_(most_faces) {}

  polygons parse() {
    const object asset = gltf_.child("asset");
    if (const std::string& version = asset.text("version"); version.rfind("2.", 0) != 0)
      throw input_error(asset.place("version"), quotation(version), "glTF 2.0");
    check_extensions();
    read_trees();
    struct visit {
      std::size_t node;
      glm::dmat4 transform;
    };
    std::vector<visit> open;
    const std::vector<std::size_t> roots = scene_nodes();
    for (auto n = roots.rbegin(); n != roots.rend(); ++n) open.push_back({*n, glm::dmat4(1.0)});
    while (!open.empty()) {
      const visit at = open.back();
      open.pop_back();
      const object node = gltf_.child("nodes", at.node);
      const glm::dmat4 transform = at.transform * transform_of(node);
      if (node.has("mesh")) add_mesh(node, transform);
      const auto& children = children_[at.node];
      for (auto n = children.rbegin(); n != children.rend(); ++n) open.push_back({*n, transform});
    }
    return std::move(polygons_);
  }

 private:
  void check_extensions() {
    for (const json& name : gltf_.array("extensionsRequired")) {
      const std::string text = name.is_string() ? name.get<std::string>() : std::string();
      if (text == "KHR_mesh_quantization")
        quantised_ = true;
      else if (text.rfind("KHR_materials_", 0) != 0 && text.rfind("KHR_texture_", 0) != 0)
        throw input_error(gltf_.place("extensionsRequired"), shown(name), "a glTF without such an extension");
    }
  }

  // Each node has one parent at most, and the way up ends.
  void read_trees() {
    const std::size_t none = gltf_.size("nodes");
    children_.resize(none);
    parents_.assign(none, none);
    for (std::size_t n = 0; n < none; ++n) {
      children_[n] = gltf_.child("nodes", n).indices("children", none);
      for (const std::size_t child : children_[n]) {
        if (parents_[child] != none)
          throw input_error(gltf_.place(), fmt::format("node {} has two parents", child), "nodes that form trees");
        parents_[child] = n;
      }
    }
    for (std::size_t n = 0; n < none; ++n) {
      unsigned levels = 0;
      for (std::size_t up = n; up != none; up = parents_[up])
        if (++levels > most_node_levels)
          throw input_error(gltf_.place(), fmt::format("node {} in a loop or too deep", n),
                            fmt::format("trees of at most {} levels", most_node_levels));
    }
  }
  std::vector<std::size_t> scene_nodes() const {
    const std::size_t scenes = gltf_.size("scenes"), nodes = gltf_.size("nodes");
    if (gltf_.has("scene") || scenes != 0)
      return gltf_.child("scenes", gltf_.has("scene") ? gltf_.index("scene", scenes) : 0).indices("nodes", nodes);
    std::vector<std::size_t> roots;
    for (std::size_t n = 0; n < nodes; ++n)
      if (parents_[n] == nodes) roots.push_back(n);
    return roots;
  }

  static glm::dmat4 transform_of(const object& node) {
    if (const auto m = node.reals<16>("matrix")) {
      if (node.has("translation") || node.has("rotation") || node.has("scale"))
        throw input_error(node.place(), "a matrix and its parts", "one of these");
      glm::dmat4 matrix;
      for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = (*m)[static_cast<std::size_t>(i)];
      return matrix;
    }
    glm::dmat4 matrix(1.0);
    if (const auto q = node.reals<4>("rotation")) {
      const double length = std::sqrt((*q)[0] * (*q)[0] + (*q)[1] * (*q)[1] + (*q)[2] * (*q)[2] + (*q)[3] * (*q)[3]);
      if (!(length > 0)) throw input_error(node.place("rotation"), "a quaternion of length 0", "a unit quaternion");
      const double x = (*q)[0] / length, y = (*q)[1] / length, z = (*q)[2] / length, w = (*q)[3] / length;
      matrix[0] = {1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0};
      matrix[1] = {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0};
      matrix[2] = {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0};
    }
    if (const auto s = node.reals<3>("scale"))
      for (int k = 0; k < 3; ++k) matrix[k] *= (*s)[static_cast<std::size_t>(k)];
    if (const auto t = node.reals<3>("translation")) matrix[3] = {(*t)[0], (*t)[1], (*t)[2], 1};
    return matrix;
  }

  void add_mesh(const object& node, const glm::dmat4& transform) {
    if (node.has("skin")) throw input_error(node.place("skin"), "a skin", "a mesh without one, in the pose to be traced");
    const object shape = gltf_.child("meshes", node.index("mesh", gltf_.size("meshes")));
    const std::vector<double> weights = (node.has("weights") ? node : shape).reals("weights");
    for (std::size_t p = 0; p < shape.size("primitives"); ++p) add_primitive(shape.child("primitives", p), weights, transform);
  }
  accessor accessor_of(const object& o, const char* key) { return {gltf_, o.index(key, gltf_.size("accessors")), buffers_}; }

  accessor positions_of(const object& o, const char* expected) {
    accessor positions = accessor_of(o, "POSITION");
    const bool sound = positions.component_type() == component_float || (quantised_ && positions.component_type() != 5125);
    if (!sound || positions.type() != "VEC3")
      throw input_error(o.place("POSITION"), fmt::format("{} of {}", positions.type(), positions.component_type()), expected);
    return positions;
  }

  void add_primitive(const object& primitive, const std::vector<double>& weights, const glm::dmat4& transform) {
    const std::uint64_t mode = primitive.number("mode", 0, 6, triangles_mode);
    if (mode < triangles_mode) return;
    const accessor positions = positions_of(primitive.child("attributes"), "VEC3 of binary32 (5126)");
    const std::vector<std::uint32_t> corners = corners_of(primitive, mode, positions.count());
    if (corners.empty()) return;
    std::vector<std::pair<double, accessor>> moves;
    const std::size_t targets = primitive.size("targets");
    if (!weights.empty() && weights.size() != targets)
      throw input_error(primitive.place(), fmt::format("{} weights for {} morph targets", weights.size(), targets), "one for each");
    for (std::size_t t = 0; t < weights.size(); ++t) {
      const object target = primitive.child("targets", t);
      if (weights[t] == 0 || !target.has("POSITION")) continue;
      moves.emplace_back(weights[t], positions_of(target, "VEC3 of binary32 (5126)"));
      if (moves.back().second.count() != positions.count())
        throw input_error(target.place("POSITION"), fmt::format("{} positions", moves.back().second.count()),
                          fmt::format("{}", positions.count()));
    }

    std::vector<std::uint32_t> used = corners;
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    const std::size_t first = polygons_.vertices.size();
    for (const std::uint32_t v : used) {
      glm::dvec4 p(0, 0, 0, 1);
      for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        p[k] = positions.value(v, axis);
        for (const auto& [weight, move] : moves) p[k] += weight * move.value(v, axis);
      }
      polygons_.vertices.emplace_back(transform * p);
    }
    const bool mirrored = glm::determinant(glm::dmat3(transform)) < 0;
    for (std::size_t c = 0; c < corners.size(); c += 3) {
      std::array<std::uint32_t, 3> face;
      for (std::size_t k = 0; k < 3; ++k)
        face[k] = static_cast<std::uint32_t>(
            first + static_cast<std::size_t>(std::lower_bound(used.begin(), used.end(), corners[c + k]) - used.begin()));
      if (mirrored) std::swap(face[1], face[2]);
      polygons_.add(face);
    }
  }

  // The positions that a primitive's triangles use, three for each.
  std::vector<std::uint32_t> corners_of(const object& primitive, std::uint64_t mode, std::uint64_t positions) {
    std::optional<accessor> indices;
    if (primitive.has("indices")) {
      indices.emplace(accessor_of(primitive, "indices"));
      const std::uint64_t type = indices->component_type();
      if (indices->type() != "SCALAR" || (type != 5121 && type != 5123 && type != 5125))
        throw input_error(primitive.place("indices"), fmt::format("{} of {}", indices->type(), type), "SCALAR of 5121, 5123 or 5125");
    }
    const std::uint64_t count = indices ? indices->count() : positions;
    if (mode == triangles_mode && count % 3 != 0)
      throw input_error(primitive.place(), fmt::format("{} corners of triangles", count), "a multiple of three");
    const std::uint64_t faces = mode == triangles_mode ? count / 3 : count < 3 ? 0 : count - 2;
    if (faces > most_faces_ - polygons_.sizes.size())
      throw input_error(gltf_.place(), "a mesh of more triangles", fmt::format("at most {}", most_faces_));
    const auto position = [&](std::uint64_t corner) {
      if (!indices) return static_cast<std::uint32_t>(corner);
      const auto index = static_cast<std::uint64_t>(indices->value(corner));
      if (index >= positions)
        throw input_error(primitive.place("indices"), fmt::format("vertex {}", index), fmt::format("one of the {} positions", positions));
      return static_cast<std::uint32_t>(index);
    };
    std::vector<std::uint32_t> corners;
    corners.reserve(static_cast<std::size_t>(3 * faces));
    for (std::uint64_t f = 0; f < faces; ++f) {
      std::array<std::uint64_t, 3> from{3 * f, 3 * f + 1, 3 * f + 2};
      if (mode == strip_mode) from = {f, f + 1 + f % 2, f + 2 - f % 2};
      if (mode == fan_mode) from = {f + 1, f + 2, 0};
      for (const std::uint64_t corner : from) corners.push_back(position(corner));
    }
    return corners;
  }

  static constexpr std::uint64_t triangles_mode = 4, strip_mode = 5, fan_mode = 6;

  object gltf_;
  buffer_store buffers_;
  std::uint64_t most_faces_;
  bool quantised_ = false;  // KHR_mesh_quantization is required
  std::vector<std::vector<std::size_t>> children_;
  std::vector<std::size_t> parents_;  // as many as nodes: none
  polygons polygons_;
};

// --- .glb ---

struct glb {
  std::string_view text;
  std::optional<std::string_view> chunk;
};

// Header: magic, version, length; then chunks: length, kind, bytes. The first is the JSON, the second may be the buffer.
glb parse_glb(std::string_view bytes, const std::string& place) {
  constexpr std::uint32_t magic = 0x46546c67, json_kind = 0x4e4f534a, binary_kind = 0x004e4942;
  constexpr std::size_t header_bytes = 12, chunk_bytes = 8;
  const auto word = [&](std::size_t at) { return binary_value<std::uint32_t>(bytes, at, false); };
  if (bytes.size() < header_bytes + chunk_bytes || word(0) != magic)
    throw input_error(place, "another beginning", "a binary glTF, which begins with glTF");
  if (word(4) != 2) throw input_error(place, fmt::format("version {}", word(4)), "version 2");
  if (word(8) != bytes.size())
    throw input_error(place, fmt::format("{} bytes", bytes.size()), fmt::format("{}, as its header says", word(8)));
  glb parts;
  std::size_t at = header_bytes;
  for (unsigned n = 0; at < bytes.size(); ++n) {
    const std::size_t left = bytes.size() - at;
    if (left < chunk_bytes || word(at) > left - chunk_bytes)
      throw input_error(place, fmt::format("{} bytes for a chunk", left), "a chunk inside of the file");
    const std::string_view chunk = bytes.substr(at + chunk_bytes, word(at));
    const std::uint32_t kind = word(at + 4);
    if ((n == 0) != (kind == json_kind) || (n != 1 && kind == binary_kind))
      throw input_error(place, fmt::format("chunk {} of kind {:#x}", n, kind), "a JSON chunk, then a BIN chunk or none, then unknown ones");
    if (kind == json_kind) parts.text = chunk;
    if (kind == binary_kind) parts.chunk = chunk;
    at += chunk_bytes + chunk.size();
  }
  return parts;
}

}  // namespace

polygons parse_gltf(std::string_view bytes, bool binary, const std::string& place, std::uint64_t most_faces,
                    const beside_reader& read_beside) {
  const glb parts = binary ? parse_glb(bytes, place) : glb{bytes, std::nullopt};
  const json document = parse_json(parts.text, place);
  return gltf_parser(document, parts.chunk, place, most_faces, read_beside).parse();
}

}  // namespace rtusim
