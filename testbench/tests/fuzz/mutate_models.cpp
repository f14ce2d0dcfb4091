// Reads thousands of broken model files of each format, each in a process of its own: none may crash, hang, or take more than 1 GB.
//
//     rtusim_mutations [CASES] [FORMAT]...      10,000 of each if nothing is said
//
// Case n of a format is the same file in every run. One that fails is left in the present folder.

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/formats/svo_image.h"
#include "scenes/binvox.h"
#include "scenes/mesh.h"
#include "scenes/svo_builder.h"
#include "scenes/voxeliser.h"
#include "testbench/tests/random.h"
#include "testbench/tests/scratch.h"

namespace rtusim {
namespace {

constexpr long most_kilobytes = 1 << 20;
constexpr unsigned most_seconds = 60;

using test::rng;

// --- sound files ---

template <class Value>
void append(std::string& bytes, Value value, bool big_endian = false) {
  std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
  if (big_endian) std::reverse(raw.begin(), raw.end());
  bytes += raw;
}

// A ring of `sides` corners around and as many across it: closed, of triangles that all differ.
mesh torus(unsigned sides) {
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

std::string gltf(const mesh& m) {
  return gltf_json(m, fmt::format(R"(,"uri":"data:application/octet-stream;base64,{}")", base64(gltf_buffer(m))));
}

std::string glb(const mesh& m) {
  std::string json = gltf_json(m, {}), buffer = gltf_buffer(m);
  json.append((4 - json.size() % 4) % 4, ' ');
  buffer.append((4 - buffer.size() % 4) % 4, '\0');
  std::string s = "glTF";
  append(s, std::uint32_t{2});
  append(s, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + buffer.size()));
  append(s, static_cast<std::uint32_t>(json.size()));
  s += "JSON" + json;
  append(s, static_cast<std::uint32_t>(buffer.size()));
  return s + std::string("BIN\0", 4) + buffer;
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

std::string bytes_written(const std::function<void(const std::filesystem::path&)>& write) {
  const test::scratch_folder folder;
  write(folder / "file");
  return config::read_file(folder / "file");
}

// --- what is done to them ---

void read_as_mesh(const std::filesystem::path& file) {
  const mesh m = read_mesh(file);
  find_open_edges(m);
  find_turned_edges(m);
  build_svo(voxelise_surface(m, 32), file.string());
}

void read_as_voxels(const std::filesystem::path& file) { build_svo(read_binvox(file).grid, file.string()); }

void read_as_octree(const std::filesystem::path& file) {
  const svo_limits limits{26, 20};
  const svo_image image = read_svo(file, limits);
  describe(image, file.string(), limits);
  coarse_voxels_of(image, 64);
}

struct format {
  std::string name;  // also the file's ending, up to a dash
  std::string sound;
  void (*read)(const std::filesystem::path&);

  std::string ending() const { return '.' + name.substr(0, name.find('-')); }
};

std::vector<format> formats() {
  const mesh m = torus(8);
  const voxel_grid grid = voxelise_surface(m, 32);
  const std::string text = ply(m, "ascii");
  return {{"ply-text", text, read_as_mesh},
          {"ply-little", ply(m, "binary_little_endian"), read_as_mesh},
          {"ply-big", ply(m, "binary_big_endian"), read_as_mesh},
          {"ply.gz", zipped(text), read_as_mesh},
          {"obj", obj(m), read_as_mesh},
          {"stl-text", text_stl(m), read_as_mesh},
          {"stl-binary", binary_stl(m), read_as_mesh},
          {"gltf", gltf(m), read_as_mesh},
          {"glb", glb(m), read_as_mesh},
          {"bpt", bpt(), read_as_mesh},
          {"binvox", bytes_written([&](const auto& file) { write_binvox(file, voxel_cube(grid)); }), read_as_voxels},
          {"svo", bytes_written([&](const auto& file) { write_svo(file, build_svo(grid, "torus")); }), read_as_octree}};
}

// --- mutations ---

std::size_t below(rng& random, std::size_t size) { return size == 0 ? 0 : random() % size; }

// Puts an extreme in the place of a number of a text, or one that may be sound.
void replace_number(std::string& s, rng& random) {
  constexpr const char* extremes[] = {
      "0",   "-1",   "1e308", "-1e-308", "nan", "inf",   "4294967295", "4294967296", "2147483648", "999999999", "18446744073709551616",
      "1e9", "0x7f", "",      "1.5.5",   "-",   "65536", "255",        "1000000000"};
  constexpr std::string_view digits = "0123456789";
  const std::size_t from = s.find_first_of(digits, below(random, s.size()));
  if (from == s.npos) return;
  const std::size_t to = std::min(s.find_first_not_of("0123456789.eE", from), s.size());
  s.replace(from, to - from, random() % 2 == 0 ? extremes[below(random, std::size(extremes))] : fmt::format("{}", random() % 200));
}

void replace_word(std::string& s, rng& random) {
  constexpr std::uint32_t extremes[] = {0,       1,          0x7f,       0xff,       0x7fff,     0xffff,
                                        0x10000, 0x7fffffff, 0x80000000, 0xffffffff, 0x7fc00000, 0x7f800000};
  const std::uint32_t word = extremes[below(random, std::size(extremes))];
  if (s.size() < sizeof word) return;
  std::memcpy(&s[below(random, s.size() - sizeof word + 1)], &word, sizeof word);
}

void mutate_once(std::string& s, rng& random) {
  if (s.empty()) s = "x";
  // Half of them near the beginning, where headers are.
  const std::size_t reach = random() % 2 == 0 ? std::min<std::size_t>(s.size(), 300) : s.size();
  const std::size_t at = below(random, reach), length = 1 + below(random, std::min<std::size_t>(s.size() - at, 64));
  switch (random() % 11) {
    case 0: s[at] = static_cast<char>(s[at] ^ (1 << random() % 8)); break;
    case 1: s[at] = static_cast<char>(random()); break;
    case 2: s.erase(at, length); break;
    case 3: s.insert(at, s.substr(at, length)); break;
    case 4: s.insert(at, s.substr(below(random, s.size()), length)); break;
    case 5: s.resize(below(random, s.size())); break;
    case 6:
      s.insert(at, std::string(1 + random() % 2000, static_cast<char>(random() % 2 == 0 ? random() : static_cast<unsigned char>(s[at]))));
      break;
    case 7: replace_word(s, random); break;
    case 8:
    case 9: replace_number(s, random); break;
    case 10: {
      const std::size_t line = std::min(s.find('\n', at), s.size() - 1), end = std::min(s.find('\n', line + 1), s.size() - 1);
      s.erase(line, end - line);
      break;
    }
  }
}

std::string mutant(const format& f, unsigned number) {
  rng random(number * 64 + static_cast<std::uint32_t>(f.name.size() * 7 + static_cast<unsigned char>(f.name.back())));
  std::string s = f.sound;
  for (unsigned n = number % 50 == 0 ? 0 : 1 + random() % (number % 3 == 0 ? 8 : 2); n != 0; --n) mutate_once(s, random);
  return s;
}

// --- the runs ---

enum class ending : std::uint8_t { accepted, refused, faulty };
constexpr std::size_t endings = 3;
constexpr int first_status = 20;  // the sanitizers end with 1

// In the child.
ending try_reading(const format& f, const std::filesystem::path& file) {
  try {
    f.read(file);
    return ending::accepted;
  } catch (const input_error&) {
    return ending::refused;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return ending::faulty;
  }
}

struct figures {
  std::array<unsigned, endings> count{};
  long kilobytes = 0;
  double seconds = 0;
};

bool run_case(const format& f, unsigned number, const test::scratch_folder& folder, figures& sum) {
  const auto file = folder.file("model" + f.ending(), mutant(f, number));
  const pid_t child = fork();
  if (child == 0) {
    alarm(most_seconds);
    _exit(first_status + static_cast<int>(try_reading(f, file)));
  }
  int status = 0;
  rusage use{};
  wait4(child, &status, 0, &use);
  const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); };
  sum.kilobytes = std::max(sum.kilobytes, use.ru_maxrss);
  sum.seconds = std::max(sum.seconds, seconds(use.ru_utime) + seconds(use.ru_stime));
  const int ended_with = WIFEXITED(status) ? WEXITSTATUS(status) - first_status : -1;
  const bool ended = ended_with >= 0 && ended_with < static_cast<int>(endings);
  const auto how = ended ? static_cast<ending>(ended_with) : ending::faulty;
  ++sum.count[static_cast<std::size_t>(how)];
  if (how != ending::faulty && use.ru_maxrss <= most_kilobytes) return true;
  const std::string kept = fmt::format("mutant-{}-{}{}", f.name, number, f.ending());
  std::filesystem::copy_file(file, kept, std::filesystem::copy_options::overwrite_existing);
  fmt::print(stderr, "{}: {}, {} MB\n", kept, ended ? "an error of ours" : fmt::format("status {:#x}", status), use.ru_maxrss / 1024);
  return false;
}

int run(unsigned cases, const std::vector<std::string>& wanted) {
  bool good = true;
  const test::scratch_folder folder;
  fmt::print("{:12}{:>8}{:>10}{:>9}{:>8}{:>10}{:>8}\n", "format", "cases", "accepted", "refused", "faulty", "most s", "MB");
  for (const format& f : formats()) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), f.name) == wanted.end()) continue;
    figures sum;
    for (unsigned n = 0; n < cases; ++n) good &= run_case(f, n, folder, sum);
    fmt::print("{:12}{:>8}{:>10}{:>9}{:>8}{:>10.2f}{:>8}\n", f.name, cases, sum.count[0], sum.count[1], sum.count[2], sum.seconds,
               sum.kilobytes / 1024);
    std::fflush(stdout);
    // Every fiftieth file is sound.
    good &= sum.count[0] >= cases / 50;
  }
  return good ? 0 : 1;
}

}  // namespace
}  // namespace rtusim

int main(int argc, char** argv) {
  const unsigned cases = argc > 1 ? static_cast<unsigned>(std::strtoul(argv[1], nullptr, 10)) : 10'000;
  return rtusim::run(cases, {argv + std::min(argc, 2), argv + argc});
}
