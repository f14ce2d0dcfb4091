#include "testbench/tests/fuzz/models.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include <fmt/format.h>

#include "testbench/tests/model_bytes.h"

namespace rtusim::fuzz {
namespace {

using test::append;

std::string gltf_buffer(const mesh& m) {
  std::string s;
  for (const auto& v : m.vertices)
    for (int k = 0; k < 3; ++k) append(s, static_cast<float>(v[k]));
  for (const auto& t : m.triangles)
    for (const std::uint32_t i : t) append(s, static_cast<std::uint16_t>(i));
  return s;
}

std::string gltf_json(const mesh& m, const std::string& uri) {
  const std::size_t positions = 12 * m.vertices.size(), indices = 6 * m.triangles.size();
  return fmt::format(
      R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],)"
      R"("nodes":[{{"children":[1,2],"translation":[1,2,3]}},{{"mesh":0,"scale":[2,2,2]}},{{"mesh":0,"rotation":[0,1,0,0]}}],)"
      R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"mode":4,"material":0}}]}}],"materials":[{{"name":"a"}}],)"
      R"("accessors":[{{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3","min":[-3,-1,-3],"max":[3,1,3]}},)"
      R"({{"bufferView":1,"byteOffset":0,"componentType":5123,"count":{},"type":"SCALAR"}}],)"
      R"("bufferViews":[{{"buffer":0,"byteLength":{}}},{{"buffer":0,"byteOffset":{},"byteLength":{}}}],)"
      R"("buffers":[{{"byteLength":{}{}}}]}})",
      m.vertices.size(), 3 * m.triangles.size(), positions, positions, indices, positions + indices, uri);
}

std::string base64(const std::string& bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string s;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t b = 0; b < 3; ++b) word = (word << 8) | (i + b < bytes.size() ? static_cast<unsigned char>(bytes[i + b]) : 0U);
    for (std::size_t d = 0; d < 4; ++d) s += i + d <= bytes.size() ? digits[(word >> (18 - 6 * d)) & 63] : '=';
  }
  return s;
}

}  // namespace

mesh torus() {
  constexpr unsigned sides = 8;
  mesh m;
  for (unsigned i = 0; i < sides; ++i)
    for (unsigned j = 0; j < sides; ++j) {
      const double u = 6.283185307179586 * i / sides, v = 6.283185307179586 * j / sides, r = 2 + std::cos(v);
      m.vertices.emplace_back(r * std::cos(u), std::sin(v), r * std::sin(u));
      const std::uint32_t next_i = (i + 1) % sides * sides, next_j = (j + 1) % sides, here = i * sides;
      m.triangles.push_back({here + j, here + next_j, next_i + j});
      m.triangles.push_back({next_i + j, here + next_j, next_i + next_j});
    }
  return m;
}

std::string ply(const mesh& m, const std::string& format) {
  std::string s = fmt::format(
      "ply\nformat {} 1.0\ncomment a torus\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      format, m.vertices.size(), m.triangles.size());
  const bool big = format == "binary_big_endian";
  for (const auto& v : m.vertices) {
    if (format == "ascii")
      s += fmt::format("{:.5f} {:.5f} {:.5f}\n", v.x, v.y, v.z);
    else
      for (int k = 0; k < 3; ++k) append(s, static_cast<float>(v[k]), big);
  }
  for (const auto& t : m.triangles) {
    if (format == "ascii") {
      s += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
      continue;
    }
    append(s, std::uint8_t{3});
    for (const std::uint32_t v : t) append(s, v, big);
  }
  return s;
}

std::string obj(const mesh& m) {
  std::string s = "# a torus\nmtllib none.mtl\no torus\n";
  for (const auto& v : m.vertices) s += fmt::format("v {:.5f} {:.5f} {:.5f}\n", v.x, v.y, v.z);
  s += "vt 0 0\nvn 0 0 1\ng ring\nusemtl stone\ns 1\n";
  for (const auto& t : m.triangles) s += fmt::format("f {0}/1/1 {1}//1 {2}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return s + " f -1 -2 -3 \\\n -4 # a quad\nv .5 .5 .5 1 0 0 1\nl 1 2\np 3\n";
}

std::string text_stl(const mesh& m) {
  std::string s = "solid torus\n";
  for (const auto& t : m.triangles) {
    s += "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t i : t) s += fmt::format("vertex {:.4f} {:.4f} {:.4f}\n", m.vertices[i].x, m.vertices[i].y, m.vertices[i].z);
    s += "endloop\nendfacet\n";
  }
  return s + "endsolid torus\n";
}

std::string binary_stl(const mesh& m) {
  std::string s(80, '\0');
  append(s, static_cast<std::uint32_t>(m.triangles.size()));
  for (const auto& t : m.triangles) {
    for (int k = 0; k < 3; ++k) append(s, 0.0F);
    for (const std::uint32_t i : t)
      for (int k = 0; k < 3; ++k) append(s, static_cast<float>(m.vertices[i][k]));
    append(s, std::uint16_t{0});
  }
  return s;
}

std::string gltf(const mesh& m) {
  return gltf_json(m, fmt::format(R"(,"uri":"data:application/octet-stream;base64,{}")", base64(gltf_buffer(m))));
}

std::string glb(const mesh& m) {
  std::string buffer = gltf_buffer(m);
  buffer.append((4 - buffer.size() % 4) % 4, '\0');
  return test::glb_of(gltf_json(m, {}), buffer);
}

std::string bpt() {
  std::string s = "3\n";
  for (int patch = 0; patch < 3; ++patch) {
    s += "3 3\n";
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) s += fmt::format("{:.4f} {:.4f} {:.4f}\n", 3.0 * patch + i, j / 3.0, std::sin(i + 2.0 * j));
  }
  return s;
}

std::string zipped(const std::string& bytes) {
  z_stream stream{};
  constexpr int gzip_alone = 16 + MAX_WBITS;
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, gzip_alone, 9, Z_DEFAULT_STRATEGY) != Z_OK) std::abort();
  std::string out(bytes.size() + 1000, '\0');
  stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  if (deflate(&stream, Z_FINISH) != Z_STREAM_END) std::abort();
  out.resize(out.size() - stream.avail_out);
  deflateEnd(&stream);
  return out;
}

}  // namespace rtusim::fuzz
