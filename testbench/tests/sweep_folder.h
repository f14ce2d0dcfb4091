#pragma once

#include <catch2/catch.hpp>

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "testbench/tests/program.h"
#include "testbench/tests/scratch.h"

/// Small sweeps, and what they leave.
namespace rtusim::test {

inline const std::string models = RTUSIM_SOURCE_DIR "/testbench/golden/svo/models/";
inline const std::string header = "[sweep]\nscenes = [\"scene.toml\"]\n";

/// A folder with scenes of 144 rays.
struct sweep_folder : scratch_folder {
  sweep_folder() {
    for (const auto& [name, model] : {std::pair{"scene.toml", "dragon_32"}, {"other.toml", "dragon_8"}})
      file(name, fmt::format("[scene]\nmodel = \"{}{}.svo\"\n[frame]\nwidth = 16\nheight = 9\n", models, model));
    file("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    file("mesh.toml", "[scene]\nmodel = \"mesh.obj\"\n[frame]\nwidth = 16\nheight = 9\n");
  }
  /// Runs a sweep of these lines into `out`.
  outcome sweep(const std::string& lines, const std::string& out = "out", words also = {}) const {
    file("sweep.toml", lines);
    also.insert(also.begin(), {"sweep", "sweep.toml", "--out", out});
    return rtusim(*this, also);
  }
};

using row = std::map<std::string, std::string>;

/// The rows of a table by column; no field of these tables has a line's end.
inline std::vector<row> rows_of(const std::filesystem::path& file) {
  std::vector<std::vector<std::string>> lines;
  std::string field;
  std::vector<std::string> line;
  bool quoted = false;
  for (const char c : bytes_of(file)) {
    if (c == '"') {
      quoted = !quoted;
    } else if ((c == ',' || c == '\n') && !quoted) {
      line.push_back(std::exchange(field, ""));
      if (c == '\n') lines.push_back(std::exchange(line, {}));
    } else {
      field += c;
    }
  }
  std::vector<row> rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    REQUIRE(lines[i].size() == lines[0].size());
    row& r = rows.emplace_back();
    for (std::size_t j = 0; j < lines[i].size(); ++j) r[lines[0][j]] = lines[i][j];
  }
  return rows;
}

inline std::vector<std::string> column(const std::filesystem::path& file, const std::string& name) {
  std::vector<std::string> values;
  for (row& r : rows_of(file)) values.push_back(r.at(name));
  return values;
}

/// When each point's result was written.
inline std::map<std::string, std::filesystem::file_time_type> times(const scratch_folder& folder, const std::string& out = "out") {
  std::map<std::string, std::filesystem::file_time_type> all;
  for (const auto& entry : std::filesystem::directory_iterator(folder / (out + "/points"))) {
    CHECK(entry.path().filename().string()[0] != '.');
    all[entry.path().filename().string()] = std::filesystem::last_write_time(entry.path() / "stats.json");
  }
  return all;
}

inline void check_same_tables(const scratch_folder& folder, const std::string& a, const std::string& b) {
  for (const char* name : {"/results.csv", "/results.json"}) CHECK(bytes_of(folder / (a + name)) == bytes_of(folder / (b + name)));
}

}  // namespace rtusim::test
