#include "scenes/meshes/mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "scenes/meshes/bezier_patches.h"
#include "scenes/meshes/gltf.h"
#include "scenes/meshes/polygon.h"
#include "testbench/tests/model_bytes.h"
#include "testbench/tests/scratch.h"

namespace rtusim {
namespace {

using test::append;

const std::string data = RTUSIM_SOURCE_DIR "/scenes/data/";
const std::string cases = RTUSIM_SOURCE_DIR "/testbench/tests/cases/";

// The message with which a file is refused, without its folder.
std::string refusal(const test::scratch_folder& scratch, const std::string& name, const std::string& bytes) {
  try {
    read_mesh(scratch.file(name, bytes));
  } catch (const input_error& e) {
    return std::string(e.what()).substr((scratch / "").string().size());
  }
  return "accepted";
}

// The unit cube: corner i has bit 0 for x, bit 1 for y, bit 2 for z.
glm::dvec3 corner(int i) { return {i & 1, (i >> 1) & 1, i >> 2}; }
constexpr int cube_quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};

std::string ply_header(const std::string& format, const std::string& vertices = "8", const std::string& faces = "6") {
  return "ply\nformat " + format + " 1.0\ncomment made by hand \xc3\xa9\nelement vertex " + vertices +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string numbers(const glm::dvec3& p) { return std::to_string(p.x) + ' ' + std::to_string(p.y) + ' ' + std::to_string(p.z) + '\n'; }

std::string text_ply() {
  std::string s = ply_header("ascii");
  for (int i = 0; i < 8; ++i) s += numbers(corner(i));
  for (const auto& q : cube_quads)
    s += "4 " + std::to_string(q[0]) + ' ' + std::to_string(q[1]) + ' ' + std::to_string(q[2]) + ' ' + std::to_string(q[3]) + '\n';
  return s;
}

std::string binary_ply(bool big_endian) {
  std::string s = ply_header(big_endian ? "binary_big_endian" : "binary_little_endian");
  for (int i = 0; i < 8; ++i)
    for (int k = 0; k < 3; ++k) append(s, static_cast<float>(corner(i)[k]), big_endian);
  for (const auto& q : cube_quads) {
    append(s, std::uint8_t{4});
    for (const int i : q) append(s, std::int32_t{i}, big_endian);
  }
  return s;
}

std::string obj() {
  std::string s = "# a cube\nmtllib none.mtl\n";
  for (int i = 0; i < 8; ++i) s += "v " + numbers(corner(i));
  s += "vt 0 0\nvn 0 0 1\np 1\nl 1 2 3\n";
  for (const auto& q : cube_quads) {
    s += "f";
    for (const int i : q) s += ' ' + std::to_string(i + 1) + "/1/1";
    s += '\n';
  }
  return s;
}

std::string text_stl() {
  std::string s = "solid cube\n";
  for (const auto& q : cube_quads)
    for (int half = 0; half < 2; ++half) {
      s += "facet normal 0 0 0\nouter loop\n";
      for (const int i : {q[0], q[1 + half], q[2 + half]}) s += "vertex " + numbers(corner(i));
      s += "endloop\nendfacet\n";
    }
  return s + "endsolid cube\n";
}

std::string binary_stl(std::uint32_t claimed = 12) {
  std::string s(80, '\0');
  append(s, claimed);
  for (const auto& q : cube_quads)
    for (int half = 0; half < 2; ++half) {
      for (int k = 0; k < 3; ++k) append(s, 0.0F);
      for (const int i : {q[0], q[1 + half], q[2 + half]})
        for (int k = 0; k < 3; ++k) append(s, static_cast<float>(corner(i)[k]));
      append(s, std::uint16_t{0});
    }
  return s;
}

std::string gltf_buffer() {
  std::string s;
  for (int i = 0; i < 8; ++i)
    for (int k = 0; k < 3; ++k) append(s, static_cast<float>(corner(i)[k]));
  for (const auto& q : cube_quads)
    for (int half = 0; half < 2; ++half)
      for (const int i : {q[0], q[1 + half], q[2 + half]}) append(s, static_cast<std::uint16_t>(i));
  return s;
}

// Two nodes: the outer one moves, the inner one doubles.
std::string gltf_json(const std::string& uri,
                      const std::string& nodes = R"([{"children":[1],"translation":[1,2,3]},{"mesh":0,"scale":[2,2,2]}])",
                      const std::string& position_count = "8") {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
         R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":77}]}],)"
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":)" +
         position_count +
         R"(,"type":"VEC3"},)"
         R"({"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}],)"
         R"("bufferViews":[{"buffer":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":72}],)"
         R"("buffers":[{"byteLength":168)" +
         (uri.empty() ? std::string() : R"(,"uri":")" + uri + '"') + "}]}";
}

std::string glb(const std::string& json, const std::string& buffer = gltf_buffer()) { return test::glb_of(json, buffer); }

void check_cube(const mesh& m, const glm::dvec3& lower = glm::dvec3(0), double edge = 1) {
  CHECK(m.vertices.size() == 8);
  CHECK(m.triangles.size() == 12);
  CHECK(bounds(m).lower == lower);
  CHECK(bounds(m).upper == lower + edge);
  CHECK(bounds(m).half_extent() == edge / 2);
  double area = 0;
  for (const auto& t : m.triangles) {
    const glm::dvec3 &a = m.vertices[t[0]], &b = m.vertices[t[1]], &c = m.vertices[t[2]];
    area += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  CHECK(area == Approx(6 * edge * edge));
}

}  // namespace

TEST_CASE("the models of scenes/data", "[mesh]") {
  const mesh dragon = read_mesh(data + "dragon_res4.ply");
  CHECK(dragon.vertices.size() == 5205);
  CHECK(dragon.triangles.size() == 11102);
  const mesh finer = read_mesh(data + "dragon_res3.ply.gz");
  CHECK(finer.vertices.size() == 22998);
  CHECK(finer.triangles.size() == 47794);
  CHECK(bounds(finer).lower.x == Approx(-0.107673));
  CHECK(bounds(finer).upper.y == Approx(0.196644));
  const mesh bunny = read_mesh(data + "bunny.obj");
  CHECK(bunny.vertices.size() == 1839);
  CHECK(bunny.triangles.size() == 3674);
}

TEST_CASE("the teapot of Hanika 2007", "[mesh]") {
  CHECK(read_mesh(data + "teapot.bpt").triangles.size() == 6320);
  const mesh coarse = read_mesh(data + "teapot.bpt", 4);
  CHECK(coarse.triangles.size() == 992);
  // Upright: it stands on y = 0, the lid's knob at 3.15; spout and handle along x.
  CHECK(bounds(coarse).lower.y == 0);
  CHECK(bounds(coarse).upper.y == Approx(3.15));
  CHECK(bounds(coarse).lower.z == -2);
  CHECK(bounds(coarse).upper.z == 2);
}

TEST_CASE("a patch is cut along the slow index first", "[mesh]") {
  bezier_patch flat;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) flat[static_cast<std::size_t>(4 * i + j)] = {i / 3.0, j / 3.0, 5};
  const mesh m = tessellate({flat}, 2);
  REQUIRE(m.vertices.size() == 9);
  REQUIRE(m.triangles.size() == 8);
  // Vertex 3 i + j; y and z have changed places.
  CHECK(m.vertices[0] == glm::dvec3(0, 5, 0));
  CHECK(m.vertices[1].z == Approx(0.5));
  CHECK(m.vertices[3].x == Approx(0.5));
  CHECK(m.vertices[8] == glm::dvec3(1, 5, 1));
  CHECK(m.triangles[0] == std::array<std::uint32_t, 3>{0, 3, 1});
  CHECK(m.triangles[1] == std::array<std::uint32_t, 3>{3, 4, 1});
  CHECK(m.triangles[7] == std::array<std::uint32_t, 3>{7, 8, 5});
}

TEST_CASE("neighbouring patches share their edge's vertices exactly", "[mesh]") {
  // The second patch runs the other way along the common edge.
  bezier_patch a, b;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) {
      a[4 * i + j] = {0.1 * double(i * i), 0.3 * double(j) + 0.01 * double(i * j), 0.7 / double(1 + i + j)};
      b[4 * i + j] = {3.0 - 0.1 * double(i), 0.5, 0.2 * double(j)};
    }
  for (std::size_t j = 0; j < 4; ++j) b[j] = a[12 + (3 - j)];
  const unsigned quads = 7;
  const mesh m = tessellate({a, b}, quads);
  const std::size_t patch = (quads + 1) * (quads + 1);
  for (std::size_t j = 0; j <= quads; ++j) CHECK(m.vertices[quads * (quads + 1) + j] == m.vertices[patch + quads - j]);
}

TEST_CASE("one cube in every format", "[mesh]") {
  const test::scratch_folder scratch;
  check_cube(read_mesh(scratch.file("a.ply", text_ply())));
  check_cube(read_mesh(scratch.file("b.ply", binary_ply(false))));
  check_cube(read_mesh(scratch.file("c.PLY", binary_ply(true))));
  check_cube(read_mesh(scratch.file("a.obj", obj())));
  check_cube(read_mesh(scratch.file("a.stl", text_stl())));
  check_cube(read_mesh(scratch.file("b.stl", binary_stl())));
  scratch.file("cube.bin", gltf_buffer());
  check_cube(read_mesh(scratch.file("a.gltf", gltf_json("cube.bin"))), {1, 2, 3}, 2);
  check_cube(read_mesh(scratch.file("a.glb", glb(gltf_json("")))), {1, 2, 3}, 2);
  const std::string matrix = R"([{"mesh":0,"matrix":[0,3,0,0, -3,0,0,0, 0,0,3,0, 7,8,9,1]}])";
  check_cube(read_mesh(scratch.file("b.glb", glb(gltf_json("", matrix)))), {4, 8, 9}, 3);
}

TEST_CASE("a mesh is turned with any axis up", "[mesh]") {
  const glm::dvec3 ways[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (unsigned axis = 0; axis < 3; ++axis)
    for (const bool negative : {false, true}) {
      mesh m;
      m.vertices.assign(std::begin(ways), std::end(ways));
      turn_up(m, axis, negative);
      CAPTURE(axis, negative);
      CHECK(m.vertices[axis] == glm::dvec3(0, negative ? -1 : 1, 0));
      CHECK(glm::cross(m.vertices[0], m.vertices[1]) == m.vertices[2]);  // turned, not mirrored
    }
}

TEST_CASE("polygons become triangles, those without area are left out", "[mesh]") {
  const test::scratch_folder scratch;
  // An L of six corners, and a face whose corners lie on a line.
  const std::string l = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\nv 4 0 0\nf 1 2 7\n";
  const mesh m = read_mesh(scratch.file("l.obj", l));
  CHECK(m.triangles.size() == 4);
  double area = 0;
  for (const auto& t : m.triangles)
    area += 0.5 * glm::length(glm::cross(m.vertices[t[1]] - m.vertices[t[0]], m.vertices[t[2]] - m.vertices[t[0]]));
  CHECK(area == Approx(3));
}

TEST_CASE("concave polygons are covered exactly once", "[mesh]") {
  const auto area_of = [](const std::vector<glm::dvec3>& corners) {
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i < corners.size(); ++i) indices.push_back(i);
    // Triangles that overlap would either exceed the polygon or turn the other way.
    double area = 0, turned = 0;
    for (const auto& t : triangulate(corners, indices)) {
      const double n = 0.5 * glm::cross(corners[t[1]] - corners[t[0]], corners[t[2]] - corners[t[0]]).z;
      area += n;
      turned += std::abs(n);
    }
    CHECK(turned == Approx(std::abs(area)));
    return area;
  };
  CHECK(area_of({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}}) == 3);
  CHECK(area_of({{0, 2, 0}, {1, 2, 0}, {1, 1, 0}, {2, 1, 0}, {2, 0, 0}, {0, 0, 0}}) == -3);
  CHECK(area_of({{0, 0, 0}, {2, 0, 0}, {1, 0.5, 0}, {0, 2, 0}}) == 1.5);                    // an arrowhead
  CHECK(area_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}}) == 4);  // corners along an edge
  // Stars and combs of many corners.
  for (const int points : {5, 50, 500}) {
    std::vector<glm::dvec3> star, comb;
    double expected = 0;
    for (int i = 0; i < 2 * points; ++i) {
      const double angle = 3.141592653589793 * i / points, radius = i % 2 != 0 ? 0.3 : 1;
      star.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.01 * (i % 3));
    }
    for (std::size_t i = 0; i < star.size(); ++i) {
      const glm::dvec3 &a = star[i], &b = star[(i + 1) % star.size()];
      expected += 0.5 * (a.x * b.y - a.y * b.x);
    }
    CHECK(area_of(star) == Approx(expected));
    for (int i = 0; i < points; ++i) {
      comb.emplace_back(2 * i, 0, 0);
      comb.emplace_back(2 * i + 1, 0, 0);
      comb.emplace_back(2 * i + 1, 10, 0);
      comb.emplace_back(2 * i + 2, 10, 0);
    }
    comb.resize(static_cast<std::size_t>(std::min(4 * points, 998)));
    comb.emplace_back(comb.back().x, 20, 0);
    comb.emplace_back(0, 20, 0);
    double comb_area = 0;
    for (std::size_t i = 0; i < comb.size(); ++i) {
      const glm::dvec3 &a = comb[i], &b = comb[(i + 1) % comb.size()];
      comb_area += 0.5 * (a.x * b.y - a.y * b.x);
    }
    CHECK(area_of(comb) == Approx(comb_area));
  }
  // A pentagram crosses itself: some triangles over its corners.
  const std::vector<glm::dvec3> pentagram = {{0, 1, 0}, {0.6, -0.8, 0}, {-1, 0.3, 0}, {1, 0.3, 0}, {-0.6, -0.8, 0}};
  CHECK(triangulate(pentagram, {0, 1, 2, 3, 4}).size() == 3);
}

TEST_CASE("bad meshes are refused in one line that names the place", "[mesh]") {
  using Catch::Matchers::Contains;
  using Catch::Matchers::StartsWith;
  const test::scratch_folder scratch;
  const auto says = [&](const std::string& name, const std::string& bytes, const std::string& beginning) {
    const std::string message = refusal(scratch, name, bytes);
    CHECK_THAT(message, StartsWith(name + beginning));
    CHECK(message.find('\n') == std::string::npos);
  };
  const std::string plane = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

  CHECK_THROWS_AS(read_mesh(scratch / "none.ply"), input_error);
  CHECK_THROWS_AS(read_mesh(scratch / ""), input_error);
  std::filesystem::create_directory(scratch / "folder.ply");
  CHECK_THROWS_AS(read_mesh(scratch / "folder.ply"), input_error);
  says("a.fbx", "x", ": a mesh ending in \".fbx\"");
  for (const char* name : {"a.ply", "a.obj", "a.stl", "a.gltf", "a.glb", "a.bpt", "a.ply.gz"}) {
    says(name, "", ": an empty file");
    CHECK(refusal(scratch, name, "\x1f\x8b garbage \x01\x02\xff\xfe\n\n 1 2 3") != "accepted");
    CHECK(refusal(scratch, name, "garbage \x01\x02\xff\xfe\n\n 1 2 3") != "accepted");
  }

  // PLY
  says("a.ply", "plx\n", ":1: another first line");
  says("a.ply", ply_header("ebcdic"), ":2: the format \"ebcdic\"");
  says("a.ply", ply_header("ascii", "-8"), ":4: the number of elements \"-8\"");
  says("a.ply", ply_header("ascii", "4000000000") + "0 0 0\n", ": 1 of 4000000000 elements \"vertex\"");
  says("a.ply", ply_header("binary_little_endian", "18446744073709551615"), ": 0 of 18446744073709551615 elements");
  const std::string ascii = "ply\nformat ascii 1.0\n";
  says("a.ply", ascii + "element vertex 9999999\nelement face 1\nend_header\n", ": 9999999 elements \"vertex\" without prop");
  says("a.ply", ascii + "element face 1\nproperty list uchar int vertex_indices\nend_header\n3 0 1 2\n", ": a PLY without elements");
  says("a.ply", ascii + "element vertex 1\nproperty float x\n", ":5: the end of the file");
  says("a.ply", text_ply().substr(0, text_ply().size() - 4), ":24: an element \"face\" cut short");
  says("a.ply", binary_ply(false).substr(0, binary_ply(false).size() - 1), ": 5 of 6 elements \"face\"");
  std::string edited = text_ply();
  edited.replace(edited.find("4 0 2 3 1"), 9, "4 0 2 3 8");
  says("a.ply", edited, ": face 0 has vertex 8");
  edited = text_ply();
  edited.replace(edited.find("4 0 2 3 1"), 9, "999999999 0 2 3 1");
  says("a.ply", edited, ":19: an element \"face\" cut short");
  edited = text_ply();
  edited.replace(edited.find("1.000000"), 8, "nan");
  says("a.ply", edited, ":12: \"nan\"");

  // OBJ
  says("a.obj", plane, ": no faces");
  says("a.obj", plane + "f 1 2 4\n", ":4: vertex 4");
  says("a.obj", plane + "f 1 2 0\n", ":4: vertex 0");
  says("a.obj", plane + "f -1 -2 -4\n", ":4: vertex -4");
  says("a.obj", plane + "f 1 2", ":4: a face of 2 corners");
  says("a.obj", plane + "f 1 2 x\n", ":4: the corner \"x\"");
  says("a.obj", "v 0 0\n" + plane + "f 1 2 3\n", ":1: the end of the line");
  says("a.obj", "v 0 0 1e400\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ":1: \"1e400\"");
  says("a.obj", "v 0 0 3e60\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ": a half extent of 1.5e+60");
  says("a.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", ": a mesh without extent");
  says("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", ": no face has an area");
  says("a.obj", plane + "l 1 2 3\np 1\n", ": no faces");

  // STL
  says("a.stl", binary_stl(13), ": 684 bytes; expected 734");
  says("a.stl", binary_stl(4'000'000'000), ": 684 bytes");
  says("a.stl", text_stl().substr(0, 400), ":19: the end of the file");
  says("a.stl", "short", ": 5 bytes");

  // glTF
  says("a.gltf", "{\"asset\":", ": broken JSON at its byte");
  says("a.gltf", "[1]", ": an array; expected an object");
  says("a.gltf", R"({"asset":{"version":"1.0"}})", ": asset: version: \"1.0\"");
  says("a.gltf", R"({"asset":)" + std::string(100'000, '['), ": deeply nested JSON");
  says("a.gltf", gltf_json("none.bin"), ": the buffer \"none.bin\", which is not there");
  says("a.gltf", gltf_json("/dev/zero"), ": the buffer \"/dev/zero\", which is an absolute path");
  says("a.glb", glb(gltf_json("", R"([{"children":[0]}])")), ": node 0 in a loop");
  says("a.glb", glb(gltf_json("", R"([{"children":[1]},{"children":[0]}])")), ": node 0 in a loop");
  says("a.glb", glb(gltf_json("", R"([{"children":[2]},{"children":[2]},{"mesh":0}])")), ": node 2 has two parents");
  says("a.glb", glb(gltf_json("", R"([{"mesh":1}])")), ": nodes[0]: mesh: 1");
  says("a.glb", glb(gltf_json("", R"([{"mesh":"x"}])")), ": nodes[0]: mesh: ");
  says("a.glb", glb(gltf_json("", R"([{"mesh":0}])", "2000000000")), ": accessors[0]: 24000000000 bytes");
  says("a.glb", glb(gltf_json("", R"([{"mesh":0}])", "100000")), ": ");
  says("a.glb", glb(gltf_json("", "[{}]")), ": no faces");
  says("a.glb", glb(gltf_json("")).substr(0, 500), ": 500 bytes");

  // Bezier patches
  says("a.bpt", "x", ":1: \"x\"");
  says("a.bpt", "0\n", ": no faces");
  says("a.bpt", "1\n2 3\n", ":2: a patch of degree 2");
  says("a.bpt", "4000000000\n3 3\n1 2 3\n", ":4: the end of the file");
  says("a.bpt", "1\n3 3\n1 2 nan\n", ":3: the coordinate nan");
  std::string patch = "1\n3 3\n";
  for (int i = 0; i < 16; ++i) patch += "1 2 3\n";
  says("a.bpt", patch, ": a mesh without extent");
  says("a.bpt", patch + "4\n", ":19: \"4\"");
  for (const char* far : {"1e308", "-1e-315"}) {
    std::string extreme = "1\n3 3\n";
    for (int i = 0; i < 16; ++i) extreme += i % 2 != 0 ? "0 0 0\n" : std::string(far) + " 0 0\n";
    says("a.bpt", extreme, ": a half extent of ");
  }
}

TEST_CASE("files cut short never crash the reader", "[mesh]") {
  const test::scratch_folder scratch;
  struct sample {
    const char* name;
    std::string bytes;
  };
  const sample samples[] = {{"a.ply", text_ply()}, {"b.ply", binary_ply(true)}, {"a.obj", obj()},
                            {"a.stl", text_stl()}, {"b.stl", binary_stl()},     {"a.glb", glb(gltf_json(""))}};
  for (const sample& s : samples) {
    unsigned refused = 0;
    for (std::size_t bytes = 0; bytes < s.bytes.size(); bytes += 11)
      if (refusal(scratch, s.name, s.bytes.substr(0, bytes)) != "accepted") ++refused;
    CHECK(refused > 0);
  }
}

// What `info` tells of a mesh.
struct told {
  const char* file;
  std::size_t triangles;
  std::uint64_t open;
  glm::dvec3 upper;
};

TEST_CASE("files that other readers were seen to read wrongly are read", "[mesh]") {
  const told all[] = {{"ply_first_byte_0a_le.ply", 8, 0, {2, 3, 5}},
                      {"ply_first_byte_0a_uchar_faces_le.ply", 4, 0, {1, 1, 1}},
                      {"ply_faces_first.ply", 8, 0, {2, 3, 5}},
                      {"ply_trailing_blank_end_header.ply", 8, 0, {2, 3, 5}},
                      {"ply_tristrips_le.ply", 4, 0, {2, 3, 5}},
                      {"obj_plain.obj", 8, 0, {2, 3, 5}},
                      {"obj_leading_dot_shift.obj", 4, 0, {2, 2, 0.5}},
                      {"obj_leading_dot_one.obj", 4, 0, {2, 0.5, 2}},
                      {"obj_leading_blank_one_face.obj", 8, 0, {2, 3, 5}},
                      {"obj_comment_after_face.obj", 8, 0, {2, 3, 5}},
                      {"obj_texture_index_without_vt.obj", 4, 0, {2, 3, 5}},
                      {"obj_vertex_alpha.obj", 8, 0, {2, 3, 5}},
                      {"obj_bom.obj", 8, 0, {2, 3, 5}},
                      {"obj_cross_closed_solid.obj", 44, 0, {3, 3, 1}},
                      {"mesh_closed_by_flat_triangle.obj", 13, 0, {2, 2, 2}},
                      {"obj_bowtie_among_others.obj", 10, 4, {12, 3, 5}},
                      {"mesh_cube_one_turned.obj", 12, 0, {1, 1, 1}},
                      {"gltf_seam_between_nodes.gltf", 4, 0, {2.3, 3, 5}},
                      {"gltf_uri_percent.gltf", 8, 0, {2, 3, 5}},
                      {"gltf_morph_weight_one.gltf", 8, 0, {4, 6, 10}},
                      {"glb_external_buffer.glb", 8, 0, {2, 3, 5}},
                      {"stl_upper_case.stl", 8, 0, {2, 3, 5}},
                      {"stl_normal_nan_ind.stl", 4, 0, {2, 3, 5}}};
  for (const told& t : all) {
    CAPTURE(t.file);
    const mesh m = read_mesh(cases + t.file);
    CHECK(m.triangles.size() == t.triangles);
    CHECK(find_open_edges(m).count == t.open);
    for (int k = 0; k < 3; ++k) CHECK(bounds(m).upper[k] == Approx(t.upper[k]).epsilon(1e-5));
  }
  for (const char* file : {"gltf_index_too_large.gltf", "stl_second_solid_cut_at_facet.stl", "stl_facet_four_vertices.stl"})
    CHECK_THROWS_AS(read_mesh(cases + file), input_error);
}

TEST_CASE("coordinates keep their binary64", "[mesh]") {
  const mesh far = read_mesh(cases + "obj_far_from_origin.obj");
  REQUIRE(far.vertices.size() == 6);
  CHECK(far.vertices[0] == glm::dvec3(500000.250, 5400000.500, 100.000));
  CHECK(far.vertices[4] == glm::dvec3(500000.450, 5400000.500, 100.500));
  CHECK(bounds(far).upper.y - bounds(far).lower.y == Approx(0.3));

  // The same distance as text PLY, as a PLY of binary64, as text STL, and moved there by a node.
  const test::scratch_folder scratch;
  const auto moved = [](const glm::dvec3& p) { return glm::dvec3(5e6, 4e6, 3e6) + 0.001 * p; };
  const auto text = [&](const glm::dvec3& p) { return fmt::format("{} {} {}\n", moved(p).x, moved(p).y, moved(p).z); };
  std::string ply = ply_header("ascii"), wide = ply_header("binary_little_endian"), stl = "solid\n";
  for (std::size_t at = 0; (at = wide.find("float", at)) != wide.npos;) wide.replace(at, 5, "double");
  for (int i = 0; i < 8; ++i) {
    ply += text(corner(i));
    for (int k = 0; k < 3; ++k) append(wide, moved(corner(i))[k]);
  }
  for (const auto& q : cube_quads) {
    ply += fmt::format("4 {} {} {} {}\n", q[0], q[1], q[2], q[3]);
    append(wide, std::uint8_t{4});
    for (const int i : q) append(wide, std::int32_t{i});
    for (int half = 0; half < 2; ++half) {
      stl += "facet normal 0 0 0\nouter loop\n";
      for (const int i : {q[0], q[1 + half], q[2 + half]}) stl += "vertex " + text(corner(i));
      stl += "endloop\nendfacet\n";
    }
  }
  const std::string node = R"([{"mesh":0,"translation":[5000000,4000000,3000000],"scale":[0.001,0.001,0.001]}])";
  for (const auto& file : {scratch.file("a.ply", ply), scratch.file("b.ply", wide), scratch.file("a.stl", stl + "endsolid\n"),
                           scratch.file("a.glb", glb(gltf_json("", node)))}) {
    CAPTURE(file.string());
    const mesh m = read_mesh(file);
    CHECK(m.vertices.size() == 8);
    CHECK(m.triangles.size() == 12);
    CHECK(find_open_edges(m).count == 0);
    CHECK(bounds(m).half_extent() == Approx(0.0005).epsilon(1e-5));
  }
}

TEST_CASE("vertices that agree in binary32 are one", "[mesh]") {
  const test::scratch_folder scratch;
  const auto read = [&](const std::string& text) { return read_mesh(scratch.file("a.obj", text)); };
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  // The second face's corners differ in the tenth digit, at 0 and elsewhere, and stay where the first put them.
  const mesh close = read(square + "f 1 2 3\nv -1e-14 1e-15 2e-14\nv 1.0000000001 0.9999999999 1e-9\nf 5 6 4\n");
  CHECK(close.vertices.size() == 4);
  CHECK(close.vertices[0] == glm::dvec3(0, 0, 0));
  CHECK(find_open_edges(close).count == 4);
  // In the sixth they are others.
  CHECK(read(square + "f 1 2 3\nv 0 0 0\nv 1.000001 1 0\nf 5 6 4\n").vertices.size() == 5);
  // A face keeps its corners, however fine it is.
  const mesh fine = read(square + "f 1 2 3 4\nv 2 2 2\nv 2.00000001 2 2\nv 2 2.00000001 2\nf 5 6 7\n");
  CHECK(fine.vertices.size() == 7);
  CHECK(fine.triangles.size() == 3);
  // Far from the origin they are compared as if they were near it.
  const std::string far = "v 8000000 0 0\nv 8000001 0 0\nv 8000001 1 0\nv 8000000 1 0\nv 8000000.1 1 0\n";
  CHECK(read(far + "f 1 2 3\nf 1 3 4\nf 1 3 5\n").vertices.size() == 5);
}

TEST_CASE("every corner and every edge of a polygon counts for whether a mesh closes", "[mesh]") {
  const test::scratch_folder scratch;
  const auto read = [&](const std::string& text) { return read_mesh(scratch.file("a.obj", text)); };
  // A box, some of whose edges have a corner in their middle on one side or on both.
  const std::string box =
      "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2\nv 1 0 0\nv 1 0 2\n"
      "f 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  const mesh both = read(box + "f 1 4 3 2 9\nf 5 10 6 7 8\nf 1 9 2 6 10 5\n");
  CHECK(find_open_edges(both).count == 0);
  CHECK(both.triangles.size() == 2 * 3 + 3 + 3 + 4);
  CHECK(both.flat_triangles.empty());
  CHECK(find_open_edges(read(box + "f 1 4 3 2\nf 5 10 6 7 8\nf 1 9 2 6 10 5\n")).count == 3);  // a real slit, from 1 to 9 to 2
  const mesh sewn = read(box + "f 1 4 3 2\nf 5 10 6 7 8\nf 1 9 2 6 10 5\nf 1 2 9\n");
  CHECK(find_open_edges(sewn).count == 0);
  CHECK(find_turned_edges(sewn).count == 0);
  CHECK(sewn.flat_triangles.size() == 1);
  // A corner twice, and a spike, there and back.
  for (const char* front : {"f 1 9 9 2 6 10 5\n", "f 1 9 2 6 7 6 10 5\n"}) {
    const mesh odd = read(box + "f 1 4 3 2 9\nf 5 10 6 7 8\n" + front);
    CAPTURE(front);
    CHECK(find_open_edges(odd).count == 0);
    CHECK(find_turned_edges(odd).count == 0);
  }
  // Bow ties in each of the planes, whose parts cancel out, and one whose parts do not.
  for (const char* tie :
       {"v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 2 0\n", "v 0 0 0\nv 0 2 2\nv 0 2 0\nv 0 0 2\n", "v 0 0 0\nv 2 0 2\nv 2 0 0\nv 0 0 2\n",
        "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 1 0\n", "v 0 0 1\nv 2 2 3\nv 2 0 1\nv 0 2 3\n"}) {
    CAPTURE(tie);
    const mesh m = read(std::string(tie) + "f 1 2 3 4\n");
    CHECK(m.triangles.size() == 2);
    CHECK(find_open_edges(m).count == 4);
  }
}

TEST_CASE("edges that lack a face are told from edges whose faces are turned", "[mesh]") {
  const mesh turned = read_mesh(cases + "mesh_cube_one_turned.obj");
  CHECK(find_turned_edges(turned).count == 4);
  CHECK(find_turned_edges(read_mesh(cases + "obj_plain.obj")).count == 0);
  mesh m;
  m.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  m.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  CHECK(find_open_edges(m).count == 0);
  std::swap(m.triangles[2][0], m.triangles[2][1]);
  CHECK(find_open_edges(m).count == 0);
  CHECK(find_turned_edges(m).count == 3);
  CHECK(find_turned_edges(m).first == std::array<glm::dvec3, 2>{m.vertices[1], m.vertices[2]});
  m.triangles.push_back({0, 1, 4});  // a fin: three faces at one edge, one at two
  CHECK(find_open_edges(m).count == 3);
  CHECK(find_open_edges(m).first == std::array<glm::dvec3, 2>{m.vertices[0], m.vertices[1]});
  m.triangles.push_back({1, 0, 4});  // both its sides
  CHECK(find_open_edges(m).count == 0);
  CHECK(find_turned_edges(m).count == 3);
}

TEST_CASE("triangles know the file's face that they are a part of", "[mesh]") {
  const test::scratch_folder scratch;
  // Of five faces the first has no area, the third four corners, and the last no area either.
  const mesh obj = read_mesh(
      scratch.file("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 0 0 1\nf 1 2 5\nf 1 2 6\nf 1 2 3 4\nf 2 3 6\nf 2 5 1\n"));
  CHECK(obj.faces == std::vector<std::uint32_t>{1, 2, 2, 3});
  CHECK(obj.face_of(3) == 3);
  CHECK(obj.flat_triangles.size() == 2);
  const mesh ply = read_mesh(scratch.file("a.ply",
                                          "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                                          "element face 4\nproperty list uchar int vertex_index\nend_header\n"
                                          "0 0 0\n1 0 0\n0 1 0\n0 0 1\n2 0 1\n3 0 0 1\n4 0 1 2 3\n3 1 2 3\n"));
  CHECK(ply.faces == std::vector<std::uint32_t>{2, 2, 3});
  const mesh bpt = read_mesh(data + "teapot.bpt");
  CHECK(bpt.flat_triangles.size() == 80);
  CHECK(bpt.face_of(bpt.triangles.size() - 1) == 6399);
  // Two instances of two triangles, the first of which has no area.
  const std::string nodes = R"([{"children":[1,2]},{"mesh":0},{"mesh":0,"translation":[5,0,0]}])";
  std::string json = gltf_json("", nodes);
  json.replace(json.find("\"count\":36"), 10, "\"count\":6 ");
  std::string buffer = gltf_buffer();
  const std::uint16_t corners[] = {0, 0, 1, 0, 2, 3};
  std::memcpy(&buffer[96], corners, sizeof corners);
  const mesh gltf = read_mesh(scratch.file("a.glb", glb(json, buffer)));
  CHECK(gltf.faces == std::vector<std::uint32_t>{1, 3});
  mesh made;
  made.triangles = {{0, 1, 2}, {2, 1, 0}};
  CHECK(made.face_of(1) == 1);
}

TEST_CASE("files beside a glTF are read from its folder and below", "[mesh]") {
  using Catch::Matchers::Contains;
  const test::scratch_folder scratch;
  std::filesystem::create_directories(scratch / "model/parts");
  const std::string buffer = gltf_buffer();
  for (const char* name : {"model/parts/a.bin", "model/\xc3\xa4 1%.bin", "outside.bin", "model/..b.bin"}) scratch.file(name, buffer);
  std::filesystem::create_symlink("../outside.bin", scratch / "model/link.bin");
  std::filesystem::create_symlink("parts/a.bin", scratch / "model/inner.bin");
  std::filesystem::create_directory_symlink("..", scratch / "model/up");
  const auto file = [&](const std::string& uri) { return scratch.file("model/a.gltf", gltf_json(uri)); };
  for (const char* uri : {"parts/a.bin", "./parts/../parts/a.bin", "parts%2Fa.bin", "%C3%A4%201%25.bin", "inner.bin", "..b.bin"}) {
    CAPTURE(uri);
    check_cube(read_mesh(file(uri)), {1, 2, 3}, 2);
  }
  const std::string absolute = (scratch / "model/parts/a.bin").string();
  for (const std::string& uri :
       {std::string("../outside.bin"), std::string("%2e%2e/outside.bin"), std::string("link.bin"), std::string("up/outside.bin"),
        std::string("parts"), std::string("a.bin%00"), std::string("parts/a.bi%"), std::string("parts/a.bi%6"),
        std::string("http://a/b.bin"), std::string("file:parts/a.bin"), std::string(""), std::string("/dev/zero"), absolute}) {
    CAPTURE(uri);
    CHECK_THROWS_AS(read_mesh(file(uri)), input_error);
  }
  scratch.file("model/parts/a.bin", buffer.substr(0, 167));
  CHECK_THROWS_WITH(read_mesh(file("parts/a.bin")), Contains("buffers[0]: 167 bytes; expected 168"));
}

TEST_CASE("bad meshes: what is rarer, format by format", "[mesh]") {
  using Catch::Matchers::Contains;
  using Catch::Matchers::StartsWith;
  const test::scratch_folder scratch;
  const auto says = [&](const std::string& name, const std::string& bytes, const std::string& found, const std::string& expected) {
    const std::string message = refusal(scratch, name, bytes);
    CHECK_THAT(message, StartsWith(name) && Contains(": " + found + "; expected " + expected));
    CHECK(message.find('\n') == std::string::npos);
  };
  // The cube with one part of its JSON replaced.
  const std::string cube = gltf_json("");
  const auto changed = [](std::string json, const std::string& part, const std::string& other) {
    const auto at = json.find(part);
    REQUIRE(at != std::string::npos);
    return json.replace(at, part.size(), other);
  };
  const auto with = [&](const std::string& part, const std::string& other) { return glb(changed(cube, part, other)); };
  const std::string indices = R"({"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"})";
  const std::string third = indices + R"(,{"componentType":5126,"count":)";  // accessors are 0 to 2
  says("a.glb", with("[2,2,2]", "[2,2,1e999]"), "JSON with a number out of range", "a glTF");
  says("a.glb", with("[2,2,2]", R"([2,2,"2"])"), R"("2")", "numbers");
  says("a.glb", with(indices, R"({"normalized":1,)" + indices.substr(1)), "1", "true or false");
  says("a.glb", with("5123", "5124"), "5124", "5120, 5121, 5122, 5123, 5125 or 5126");
  says("a.glb", with(indices, R"({"componentType":5123,"count":2000000000,"type":"SCALAR"})"), "2000000000 elements without a bufferView",
       "at most ");
  const auto sparse = [&](const std::string& code, const std::string& count) {
    return with(indices, R"({"sparse":{"count":)" + count + R"(,"indices":{"bufferView":1,"componentType":)" + code +
                             R"(},"values":{"bufferView":1}},)" + indices.substr(1));
  };
  says("a.glb", sparse("5126", "2"), "5126", "5121, 5123 or 5125");
  says("a.glb", sparse("5123", "6"), "element 0", "rising ones below 36");  // 0 2 3 0 ...: the fourth does not rise
  says("a.glb", with(R"("scene":0)", R"("extensionsRequired":["EXT_none"],"scene":0)"), R"("EXT_none")",
       "a glTF without such an extension");
  says("a.glb", with(R"("mesh":0,"scale")", R"("mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],"scale")"), "a matrix and its parts",
       "one of these");
  says("a.glb", with(R"("type":"VEC3")", R"("type":"SCALAR")"), "SCALAR of 5126", "VEC3 of binary32 (5126)");
  // Weights are the mesh's.
  const auto weighed = [&](const std::string& weights, const std::string& targets) {
    return with(R"({"primitives":[{"attributes":{"POSITION":0})",
                R"({"weights":)" + weights + R"(,"primitives":[{"targets":)" + targets + R"(,"attributes":{"POSITION":0})");
  };
  says("a.glb", weighed("[1,0]", R"([{"POSITION":0}])"), "2 weights for 1 morph targets", "one for each");
  const std::string moved = changed(cube, R"({"primitives":[{"attributes":{"POSITION":0})",
                                    R"({"weights":[1],"primitives":[{"targets":[{"POSITION":2}],"attributes":{"POSITION":0})");
  says("a.glb", glb(changed(moved, indices, third + R"(7,"type":"VEC3"})")), "7 positions", "8");
  says("a.glb", with(R"("indices":1)", R"("indices":0)"), "VEC3 of 5126", "SCALAR of 5121, 5123 or 5125");
  std::string cut_chunk = glb(cube);
  cut_chunk[12] = static_cast<char>(cut_chunk[12] ^ 0x40);
  cut_chunk[13] = static_cast<char>(cut_chunk[13] | 0x70);
  says("a.glb", cut_chunk, fmt::format("{} bytes for a chunk", cut_chunk.size() - 12), "a chunk inside of the file");

  // A saw of many teeth, and a corner at infinity.
  std::string saw;
  constexpr int teeth = 20'000;
  for (int i = 0; i < teeth; ++i) saw += fmt::format("v {} {} 0\n", i, i % 2 * 3 + 1);
  saw += fmt::format("v {} 0 0\nv 0 0 0\nf", teeth);
  for (int i = 1; i <= teeth + 2; ++i) saw += fmt::format(" {}", i);
  says("a.obj", saw + "\n", fmt::format("face 0 has {} corners and is not convex", teeth + 2), "at most ");
  std::string infinite = binary_stl();
  const float infinity = std::numeric_limits<float>::infinity();
  std::memcpy(&infinite[84 + 12], &infinity, sizeof infinity);
  says("a.stl", infinite, "vertex 0 has the coordinate inf", "finite coordinates");
  says("a.obj", "v 0 0 0\ncurv 0 1 1\n", "\"curv\"", "an OBJ of polygons, in one file");
  says("a.obj", "v 0 0 0 1 1 1 1 1\n", "\"1\" after a vertex", "a weight or a colour, four numbers at most");

  const std::string triangle = ply_header("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n";
  says("a.ply", triangle + "3 0 1 2 4\n", "\"4\" after an element \"face\"", "the end of the line");
  says("a.ply", triangle + "three 0 1 2\n", "the length of a list \"three\"", "a whole number");
  says("a.ply", triangle + "3 0 1 2\n3 0 1 2\n", "\"3\" after the last element", "as many elements as the header claims");
  std::string twice = triangle + "3 0 1 2\n";
  twice.insert(twice.find("property float y"), "property float x\n");
  says("a.ply", twice, "elements \"vertex\" with x twice", "it once");
}

TEST_CASE("mesh: more triangles than can be held are refused before they are made") {
  const test::scratch_folder scratch;
  // One polygon of fifty million corners, all of them the first vertex: zeros, which take no room on the disk.
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
      "property list uint uchar vertex_indices\nend_header\n";
  for (int coordinate = 0; coordinate < 9; ++coordinate) append(bytes, coordinate % 4 == 0 ? 1.0F : 0.0F);
  const std::uint32_t corners = 50'000'003;
  append(bytes, corners);
  const auto file = scratch.file("many.ply", bytes);
  std::filesystem::resize_file(file, bytes.size() + corners);
  CHECK_THROWS_WITH(read_mesh(file), Catch::EndsWith("many.ply: a mesh of more triangles; expected at most 50000000"));

  const std::string twice =
      R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}, {"mesh": 0}], "meshes": [{"primitives": [{"attributes": )"
      R"({"POSITION": 0}}]}], "accessors": [{"componentType": 5126, "count": 3, "type": "VEC3"}]})";
  const auto no_files = [](const std::string&, std::uint64_t) { return std::string(); };
  CHECK(parse_gltf(twice, false, "a.gltf", 2, no_files).sizes.size() == 2);
  CHECK_THROWS_WITH(parse_gltf(twice, false, "a.gltf", 1, no_files), Catch::Equals("a.gltf: a mesh of more triangles; expected at most 1"));
}

}  // namespace rtusim
