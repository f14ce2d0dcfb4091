#include "scenes/voxels/binvox.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <system_error>

#include <fmt/ranges.h>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/config/quotation.h"

namespace rtusim {
namespace {

constexpr std::uint64_t most_file_bytes = std::uint64_t{1} << 30;
constexpr unsigned most_run = 255;

std::string_view without_blanks_before(std::string_view line) { return line.substr(std::min(line.find_first_not_of(" \t"), line.size())); }

// Takes the next word off a line of a header, and the blanks around it.
std::string_view take_word(std::string_view& line) {
  line = without_blanks_before(line);
  const std::string_view word = line.substr(0, line.find_first_of(" \t"));
  line = without_blanks_before(line.substr(word.size()));
  return word;
}

template <class Number>
Number take_number(std::string_view& line, const std::string& place, const char* what) {
  const std::string_view word = take_word(line);
  Number value{};
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (status != std::errc{} || end != word.data() + word.size()) throw input_error(place, quotation(word), what);
  return value;
}

double take_finite(std::string_view& line, const std::string& place, const std::string& whole) {
  const auto value = take_number<double>(line, place, "a number");
  if (!std::isfinite(value)) throw input_error(place, whole, "finite numbers");
  return value;
}

struct header {
  unsigned version = 0;
  unsigned edge = 0;
  std::array<double, 3> translate{};
  double scale = 1;
};

unsigned take_edge(std::string_view& line, const std::string& place, const std::string& whole) {
  const char* const what = "three numbers of voxels";
  const auto x = take_number<unsigned>(line, place, what), z = take_number<unsigned>(line, place, what);
  const auto y = take_number<unsigned>(line, place, what);
  if (x != y || z != y || y < 1 || y > voxel_grid::most_resolution)
    throw input_error(place, whole, fmt::format("a cube, three times the same from 1 to {}", voxel_grid::most_resolution));
  return y;
}

// Takes the header off the bytes.
header take_header(std::string_view& bytes, const std::string& file) {
  constexpr std::size_t most_line = 4096;
  header h;
  std::set<std::string_view> met;
  for (unsigned number = 1;; ++number) {
    const std::string place = fmt::format("{}:{}", file, number);
    const std::size_t end = bytes.substr(0, most_line).find('\n');
    if (end == bytes.npos) throw input_error(place, quotation(bytes.substr(0, most_line)), "a header of #binvox 1, dim and data");
    std::string_view line = bytes.substr(0, end);
    bytes.remove_prefix(end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    const std::string whole = quotation(line);
    const std::string_view keyword = take_word(line);
    if (number == 1) {
      if (keyword != "#binvox") throw input_error(place, whole, "#binvox 1");
      h.version = take_number<unsigned>(line, place, "the version, 1 or 2");
      if (h.version < 1 || h.version > 2) throw input_error(place, fmt::format("version {}", h.version), "1 or 2");
      continue;
    }
    if (keyword.empty() || keyword.front() == '#') continue;
    if (!met.insert(keyword).second) throw input_error(place, whole, fmt::format("one line {}", printable(keyword, 40)));
    if (keyword == "dim") {
      h.edge = take_edge(line, place, whole);
    } else if (keyword == "translate") {
      for (double& t : h.translate) t = take_finite(line, place, whole);
    } else if (keyword == "scale") {
      h.scale = take_finite(line, place, whole);
    } else if (keyword != "data") {
      throw input_error(place, whole, "dim, translate, scale or data");
    }
    if (!line.empty()) throw input_error(place, whole, fmt::format("nothing after {}", whole.substr(1, whole.size() - 2 - line.size())));
    if (keyword != "data") continue;
    if (h.edge == 0) throw input_error(place, "data", "a line dim before it");
    return h;
  }
}

}  // namespace

void voxel_cube::set_edge(unsigned voxels) {
  RTU_CHECK(voxels, <=, grid.resolution());
  const double length = scale / edge;
  const double before = first();
  edge = voxels;
  for (double& t : translate) t += (first() - before) * length;
  scale = length * edge;
}

std::uint64_t voxel_cube::count() const {
  if (edge == grid.resolution()) return grid.count();
  std::uint64_t sum = 0;
  const unsigned from = first(), past = from + edge;
  for (unsigned z = from; z < past; ++z)
    for (unsigned y = from; y < past; ++y)
      for (unsigned x = from; x < past; ++x) sum += grid.at(x, y, z) ? 1 : 0;
  return sum;
}

voxel_cube read_binvox(const std::filesystem::path& file, unsigned resolution) {
  const std::string place = file.string();
  const std::string bytes = config::read_file(file, most_file_bytes);
  std::string_view runs = bytes;
  const header h = take_header(runs, place);
  if (resolution == 0)
    for (resolution = voxel_grid::least_resolution; resolution < h.edge;) resolution *= 2;
  if (resolution < h.edge)
    throw input_error(place, fmt::format("{} voxels an edge", h.edge), fmt::format("at most the resolution of {}", resolution));

  voxel_cube cube{voxel_grid(resolution)};
  cube.edge = h.edge;
  cube.translate = h.translate;
  cube.scale = h.scale;
  const unsigned first = cube.first();
  const std::uint64_t voxels = std::uint64_t{h.edge} * h.edge * h.edge;
  std::uint64_t at = 0;
  unsigned x = 0, y = 0, z = 0;
  const auto run_place = [&](std::size_t i) { return fmt::format("{}: byte {}", place, bytes.size() - runs.size() + i); };
  for (std::size_t i = 0; i + 1 < runs.size(); i += 2) {
    const unsigned value = static_cast<unsigned char>(runs[i]), length = static_cast<unsigned char>(runs[i + 1]);
    if (value > 1 && h.version == 1) throw input_error(run_place(i), fmt::format("the value {}", value), "0 or 1");
    if (length == 0) throw input_error(run_place(i + 1), "a run of 0 voxels", fmt::format("1 to {}", most_run));
    at += length;
    if (at > voxels) throw input_error(run_place(i + 1), fmt::format("voxel {}", at), fmt::format("{}, as its header claims", voxels));
    for (unsigned n = 0; n < length; ++n) {
      if (value != 0) cube.grid.fill(first + x, first + y, first + z);
      if (++y != h.edge) continue;
      y = 0;
      if (++z != h.edge) continue;
      z = 0;
      ++x;
    }
  }
  if (runs.size() % 2 != 0) throw input_error(place, "a value without its run", "pairs of bytes");
  if (at != voxels) throw input_error(place, fmt::format("{} voxels", at), fmt::format("{}, as its header claims", voxels));
  return cube;
}

void write_binvox(const std::filesystem::path& file, const voxel_cube& cube) {
  constexpr std::size_t chunk_bytes = std::size_t{1} << 20;
  const unsigned edge = cube.edge, first = cube.first();
  config::output_file out(file);
  std::string chunk =
      fmt::format("#binvox 1\ndim {0} {0} {0}\ntranslate {1}\nscale {2}\ndata\n", edge, fmt::join(cube.translate, " "), cube.scale);
  bool value = false;
  unsigned length = 0;
  const auto end_run = [&] {
    if (length == 0) return;
    chunk.push_back(static_cast<char>(value));
    chunk.push_back(static_cast<char>(length));
    length = 0;
  };
  for (unsigned x = 0; x < edge; ++x) {
    for (unsigned z = 0; z < edge; ++z)
      for (unsigned y = 0; y < edge; ++y) {
        const bool filled = cube.grid.at(first + x, first + y, first + z);
        if (filled != value || length == most_run) end_run();
        value = filled;
        ++length;
      }
    if (chunk.size() < chunk_bytes) continue;
    out.write(chunk);
    chunk.clear();
  }
  end_run();
  out.write(chunk);
  out.commit();
}

}  // namespace rtusim
