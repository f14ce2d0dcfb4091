#include "scenes/gltf_filter.h"

#include <algorithm>
#include <array>
#include <vector>

#include <nlohmann/json.hpp>

#include "modules/config/error.h"
#include "scenes/quotation.h"

namespace rtusim {
namespace {

using nlohmann::json;

constexpr int most_json_levels = 32;
constexpr unsigned most_node_levels = 256;  // the importer calls itself once a level
constexpr std::uint64_t most_number = 0x7fffffff;
constexpr std::uint64_t component_float = 5126;

constexpr std::uint32_t glb_magic = 0x46546c67, glb_json = 0x4e4f534a, glb_bin = 0x004e4942;
constexpr std::size_t glb_header_bytes = 12, glb_chunk_bytes = 8;

std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t b = 4; b-- > 0;) word = (word << 8) | static_cast<unsigned char>(bytes[at + b]);
  return word;
}

void append_little_endian(std::string& bytes, std::size_t word) {
  for (unsigned b = 0; b < 4; ++b) bytes.push_back(static_cast<char>((word >> (8 * b)) & 0xff));
}

// The deepest nesting of arrays and objects in a JSON text.
int nesting(std::string_view text) {
  int depth = 0, deepest = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      in_string = c != '"';
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      deepest = std::max(deepest, ++depth);
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return deepest;
}

json parse(std::string_view text, const std::string& place) {
  if (nesting(text) > most_json_levels) throw input_error(place, "deeply nested JSON", fmt::format("at most {} levels", most_json_levels));
  try {
    return json::parse(text);
  } catch (const json::parse_error& e) {
    throw input_error(place, fmt::format("broken JSON at its byte {}", e.byte), "a glTF");
  } catch (const json::exception&) {
    throw input_error(place, "JSON with a number out of range", "a glTF");
  }
}

// One object of the file and its counterpart for the importer; `copy_...` take a field over if it is there and right.
class field_copier {
 public:
  field_copier(const json& from, json& to, std::string place) : from_(from), to_(to), place_(std::move(place)) {
    if (!from_.is_object()) throw input_error(place_, found(from_), "an object");
    to_ = json::object();
  }

  std::uint64_t copy_number(const char* key, std::uint64_t most, bool required, std::uint64_t otherwise = 0) {
    const json* value = find(key, required);
    if (value == nullptr) return otherwise;
    if (!value->is_number_unsigned() || value->get<std::uint64_t>() > most)
      throw input_error(at(key), found(*value), fmt::format("a whole number from 0 to {}", most));
    to_[key] = *value;
    return value->get<std::uint64_t>();
  }
  void copy_index(const char* key, std::size_t size, bool required) {
    if (find(key, required) == nullptr) return;
    if (size == 0) throw input_error(at(key), "a reference", "something that it refers to");
    copy_number(key, size - 1, required);
  }
  void copy_reals(const char* key, std::size_t count) {
    const json* value = find(key, false);
    if (value == nullptr) return;
    const auto is_number = [](const json& v) { return v.is_number(); };
    if (!value->is_array() || value->size() != count || !std::all_of(value->begin(), value->end(), is_number))
      throw input_error(at(key), found(*value), fmt::format("{} numbers", count));
    to_[key] = *value;
  }
  std::string copy_text(const char* key, bool required) {
    const json* value = find(key, required);
    if (value == nullptr) return {};
    if (!value->is_string()) throw input_error(at(key), found(*value), "a text");
    to_[key] = *value;
    return value->get<std::string>();
  }
  // Indices below `size`, each once.
  std::vector<std::size_t> copy_indices(const char* key, std::size_t size) {
    const json* value = find(key, false);
    std::vector<std::size_t> indices;
    if (value == nullptr) return indices;
    if (!value->is_array()) throw input_error(at(key), found(*value), "an array");
    for (const json& v : *value) {
      if (!v.is_number_unsigned() || v.get<std::uint64_t>() >= size)
        throw input_error(at(key), found(v), fmt::format("an index below {}", size));
      indices.push_back(v.get<std::size_t>());
    }
    std::vector<std::size_t> sorted = indices;
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) throw input_error(at(key), "an index twice", "each once");
    if (!indices.empty()) to_[key] = *value;
    return indices;
  }
  // Copies an array of objects: `copy(object, index)` for each; without the array nothing happens.
  template <class Copy>
  void copy_objects(const char* key, Copy&& copy) {
    const json* value = find(key, false);
    if (value == nullptr) return;
    json& copies = to_[key] = json::array();
    for (std::size_t i = 0; i < array_size(key); ++i) {
      field_copier object((*value)[i], copies.emplace_back(), fmt::format("{}[{}]", at(key), i));
      copy(object, i);
    }
  }
  template <class Copy>
  void copy_object(const char* key, bool required, Copy&& copy) {
    if (const json* value = find(key, required)) {
      field_copier object(*value, to_[key], at(key));
      copy(object);
    }
  }
  std::size_t array_size(const char* key) const {
    const json* value = find(key, false);
    if (value == nullptr) return 0;
    if (!value->is_array()) throw input_error(at(key), found(*value), "an array");
    return value->size();
  }
  const json* find(const char* key, bool required) const {
    const auto value = from_.find(key);
    if (value != from_.end()) return &*value;
    if (required) throw input_error(place_, fmt::format("no \"{}\"", key), "one");
    return nullptr;
  }
  std::string at(const char* key) const { return fmt::format("{}: {}", place_, key); }
  static std::string found(const json& value) {
    if (value.is_structured()) return fmt::format("an {}", value.type_name());
    return value.is_string() ? quotation(value.get_ref<const std::string&>()) : value.dump();
  }

 private:
  const json& from_;
  json& to_;
  std::string place_;
};

void check_extensions(const field_copier& gltf) {
  const json* required = gltf.find("extensionsRequired", false);
  if (required == nullptr || !required->is_array()) return;
  for (const json& name : *required) {
    const std::string text = name.is_string() ? name.get<std::string>() : std::string();
    if (text.rfind("KHR_materials_", 0) != 0 && text.rfind("KHR_texture_", 0) != 0)
      throw input_error(gltf.at("extensionsRequired"), field_copier::found(name), "a glTF without such an extension");
  }
}

// Each node has one parent at most, and the way up ends.
void check_trees(const std::vector<std::vector<std::size_t>>& children, const std::string& place) {
  const std::size_t none = children.size();
  std::vector<std::size_t> parent(children.size(), none);
  for (std::size_t n = 0; n < children.size(); ++n)
    for (const std::size_t child : children[n]) {
      if (parent[child] != none) throw input_error(place, fmt::format("node {} has two parents", child), "nodes that form trees");
      parent[child] = n;
    }
  for (std::size_t n = 0; n < children.size(); ++n) {
    unsigned levels = 0;
    for (std::size_t up = n; up != none; up = parent[up])
      if (++levels > most_node_levels)
        throw input_error(place, fmt::format("node {} in a loop or too deep", n),
                          fmt::format("trees of at most {} levels", most_node_levels));
  }
}

void copy_accessor(field_copier& accessor, std::size_t views) {
  constexpr std::array<std::string_view, 7> types{"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
  accessor.copy_index("bufferView", views, false);
  accessor.copy_number("byteOffset", most_number, false);
  accessor.copy_number("componentType", most_number, true);
  accessor.copy_number("count", most_number, true);
  const std::string type = accessor.copy_text("type", true);
  if (std::find(types.begin(), types.end(), type) == types.end())
    throw input_error(accessor.at("type"), quotation(type), "SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4");
  accessor.copy_object("sparse", false, [&](field_copier& sparse) {
    sparse.copy_number("count", most_number, true);
    sparse.copy_object("indices", true, [&](field_copier& indices) {
      indices.copy_index("bufferView", views, true);
      indices.copy_number("byteOffset", most_number, false);
      indices.copy_number("componentType", most_number, true);
    });
    sparse.copy_object("values", true, [&](field_copier& values) {
      values.copy_index("bufferView", views, true);
      values.copy_number("byteOffset", most_number, false);
    });
  });
}

json filtered(const json& from, const std::string& place, std::uint64_t most_values) {
  json to;
  field_copier gltf(from, to, place);
  gltf.copy_object("asset", true, [&](field_copier& asset) {
    if (const std::string version = asset.copy_text("version", true); version.rfind("2.", 0) != 0)
      throw input_error(asset.at("version"), quotation(version), "glTF 2.0");
  });
  check_extensions(gltf);

  const std::size_t nodes = gltf.array_size("nodes"), meshes = gltf.array_size("meshes"), accessors = gltf.array_size("accessors");
  const std::size_t views = gltf.array_size("bufferViews"), buffers = gltf.array_size("buffers");
  gltf.copy_index("scene", gltf.array_size("scenes"), false);
  gltf.copy_objects("scenes", [&](field_copier& scene, std::size_t) { scene.copy_indices("nodes", nodes); });
  std::vector<std::vector<std::size_t>> children(nodes);
  gltf.copy_objects("nodes", [&](field_copier& node, std::size_t i) {
    children[i] = node.copy_indices("children", nodes);
    node.copy_index("mesh", meshes, false);
    node.copy_reals("matrix", 16);
    node.copy_reals("translation", 3);
    node.copy_reals("rotation", 4);
    node.copy_reals("scale", 3);
  });
  check_trees(children, place);
  gltf.copy_objects("buffers", [&](field_copier& buffer, std::size_t) {
    buffer.copy_number("byteLength", most_number, true);
    buffer.copy_text("uri", false);
  });
  gltf.copy_objects("bufferViews", [&](field_copier& view, std::size_t) {
    view.copy_index("buffer", buffers, true);
    view.copy_number("byteOffset", most_number, false);
    view.copy_number("byteLength", most_number, true);
    view.copy_number("byteStride", 252, false);
  });
  gltf.copy_objects("accessors", [&](field_copier& accessor, std::size_t) { copy_accessor(accessor, views); });

  std::uint64_t values = 0;
  const auto take_accessor = [&](const json& index, bool is_position, const std::string& where) {
    const json& accessor = to["accessors"][index.get<std::size_t>()];
    const bool is_float = accessor["componentType"] == component_float;
    if (accessor["type"] != (is_position ? "VEC3" : "SCALAR") || is_float != is_position)
      throw input_error(where, fmt::format("{} of {}", accessor["type"].get<std::string>(), accessor["componentType"].get<std::uint64_t>()),
                        is_position ? "VEC3 of binary32 (5126)" : "SCALAR of an integer type");
    values += accessor["count"].get<std::uint64_t>();
    if (values > most_values) throw input_error(place, "more positions and indices", fmt::format("at most {}", most_values));
  };
  gltf.copy_objects("meshes", [&](field_copier& shape, std::size_t) {
    shape.copy_objects("primitives", [&](field_copier& primitive, std::size_t) {
      primitive.copy_number("mode", 6, false);
      primitive.copy_index("indices", accessors, false);
      if (const json* index = primitive.find("indices", false)) take_accessor(*index, false, primitive.at("indices"));
      primitive.copy_object("attributes", true, [&](field_copier& attributes) {
        attributes.copy_index("POSITION", accessors, true);
        take_accessor(*attributes.find("POSITION", true), true, attributes.at("POSITION"));
      });
    });
  });
  return to;
}

std::string text_of(const json& gltf) { return gltf.dump(-1, ' ', true, json::error_handler_t::replace); }

}  // namespace

std::string filter_gltf(std::string_view bytes, bool binary, const std::string& place, std::uint64_t most_values) {
  if (!binary) return text_of(filtered(parse(bytes, place), place, most_values));

  // Header: magic, version, length; then chunks: length, kind, bytes. The first is the JSON, the second the buffer.
  if (bytes.size() < glb_header_bytes + glb_chunk_bytes || little_endian(bytes, 0) != glb_magic)
    throw input_error(place, "another beginning", "a binary glTF, which begins with glTF");
  if (little_endian(bytes, 4) != 2) throw input_error(place, fmt::format("version {}", little_endian(bytes, 4)), "version 2");
  if (little_endian(bytes, 8) != bytes.size())
    throw input_error(place, fmt::format("{} bytes", bytes.size()), fmt::format("{}, as its header says", little_endian(bytes, 8)));
  std::vector<std::string_view> chunks;
  for (std::size_t at = glb_header_bytes; at + glb_chunk_bytes <= bytes.size() && chunks.size() < 2;) {
    const std::size_t size = little_endian(bytes, at);
    const std::uint32_t kind = little_endian(bytes, at + 4);
    if (kind != (chunks.empty() ? glb_json : glb_bin) || size > bytes.size() - at - glb_chunk_bytes)
      throw input_error(place, fmt::format("a chunk of kind {:#x} and {} bytes", kind, size), "a JSON and a BIN chunk inside of the file");
    chunks.push_back(bytes.substr(at + glb_chunk_bytes, size));
    at += glb_chunk_bytes + size;
  }

  std::string body;
  const auto append_chunk = [&](std::string_view chunk, std::uint32_t kind, char filler) {
    const std::size_t padding = (4 - chunk.size() % 4) % 4;
    append_little_endian(body, chunk.size() + padding);
    append_little_endian(body, kind);
    body += chunk;
    body.append(padding, filler);
  };
  append_chunk(text_of(filtered(parse(chunks[0], place), place, most_values)), glb_json, ' ');
  if (chunks.size() > 1) append_chunk(chunks[1], glb_bin, '\0');
  std::string glb;
  append_little_endian(glb, glb_magic);
  append_little_endian(glb, 2);
  append_little_endian(glb, glb_header_bytes + body.size());
  return glb + body;
}

}  // namespace rtusim
