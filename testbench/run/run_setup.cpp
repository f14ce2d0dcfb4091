#include "testbench/run/run_setup.h"

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/rtu/core_kinds.h"
#include "scenes/meshes/mesh.h"
#include "scenes/voxels/octree_model.h"
#include "testbench/run/record_paths.h"

namespace rtusim {
namespace {

/// A model is the likeliest file to be given in place of another.
void check_is_no_model(const std::filesystem::path& file, const char* expected) {
  if (is_model(file)) throw input_error(file.string(), "a model", std::string(expected) + "; --model FILE is for models");
}

}  // namespace

run_parameters::run_parameters() {
  hardware.describe(parameters);
  hosts.describe(parameters, hardware);
  bench.describe(parameters);
  what.describe(parameters);
}

void run_setup::start_files_at(const std::filesystem::path& folder) {
  for (std::string* path : {&what.model.model, &what.model.rays}) *path = place_of(folder, *path).string();
}

run_setup::run_setup(const run_sources& from) {
  check_is_no_model(from.scene, "a scene file (TOML)");
  check_is_no_model(from.architecture, "an architecture file (TOML)");
  if (!from.architecture.empty()) parameters.read_toml(from.architecture, design::home);
  const auto core = hardware.rtu.core;
  if (!from.scene.empty()) {
    parameters.read_toml(from.scene, scene::home);
    start_files_at(from.scene.parent_path());  // and those of the command line here
  }
  // Voxels in place of the scene's mesh leave nothing to divide, a mesh in place of patches nothing to cut.
  if (holds_voxels(from.model)) parameters.forget("scene.resolution");
  if (!from.model.empty() && !has_patches(from.model)) parameters.forget("scene.patch_quads");
  for (const std::string& a : from.assignments) parameters.set(a);
  if (!from.model.empty()) what.model.model = from.model.string();
  if (hardware.rtu.core != core && parameters.leaves_unread(from.architecture)) {
    const auto word = [words = core_words()](unsigned kind) { return words[kind]; };
    throw input_error(
        "--set", fmt::format("rtu.core = {} for {}, a design of {} cores", word(hardware.rtu.core), from.architecture.string(), word(core)),
        fmt::format("--arch with one of {} cores, as those in testbench/architectures", word(hardware.rtu.core)));
  }
  check();
}

run_setup::run_setup(const nlohmann::json& recorded_parameters, const std::string& place, const std::filesystem::path& folder) {
  parameters.read_json(recorded_parameters, place);
  start_files_at(folder);
  check();
}

void run_setup::check() const {
  parameters.check_read();
  if (what.model.model.empty() && host().needs_model())
    throw input_error("run", "no model", "a scene file, --model FILE or --set scene.model=FILE");
}

}  // namespace rtusim
