#include "testbench/run/record_paths.h"

#include <functional>
#include <initializer_list>
#include <string>

namespace rtusim {
namespace {

namespace fs = std::filesystem;

fs::path real_place(const fs::path& place) {
  std::error_code unknown;
  const fs::path whole = fs::absolute(place, unknown), real = fs::weakly_canonical(whole, unknown);
  return unknown ? whole.lexically_normal() : real;
}

/// Gives each file of a record's parts the name that `rename` makes of its own.
void rename_files(nlohmann::ordered_json& inputs, nlohmann::ordered_json& parameters,
                  const std::function<fs::path(const fs::path&)>& rename) {
  const auto rename_in = [&](nlohmann::ordered_json& object, std::initializer_list<const char*> keys) {
    for (const char* key : keys)
      if (const auto at = object.find(key); at != object.end() && at->is_string()) *at = rename(at->get<std::string>()).string();
  };
  rename_in(inputs, {"scene", "architecture", "model", "jobs"});
  if (const auto scene = parameters.find("scene"); scene != parameters.end()) rename_in(*scene, {"model", "rays"});
}

}  // namespace

std::filesystem::path folder_of_record(const std::filesystem::path& record) {
  std::error_code unknown;
  if (const auto status = fs::status(record, unknown); fs::exists(status) && !fs::is_regular_file(status)) return {};
  return real_place(record).parent_path();
}

std::filesystem::path named_from(const std::filesystem::path& folder, const std::filesystem::path& file) {
  if (file.empty()) return file;
  std::error_code unknown;
  const fs::path whole = fs::absolute(file, unknown), real = real_place(whole.parent_path()) / file.filename();
  if (folder.empty()) return real;
  const fs::path from = real.lexically_relative(real_place(folder));
  return from.empty() ? real : from;
}

std::filesystem::path place_of(const std::filesystem::path& folder, const std::filesystem::path& name) {
  return name.empty() ? name : folder / name;
}

void name_files_from(const std::filesystem::path& folder, nlohmann::ordered_json& inputs, nlohmann::ordered_json& parameters) {
  rename_files(inputs, parameters, [&](const fs::path& file) { return named_from(folder, file); });
}

void name_files_in_full(const std::filesystem::path& folder, nlohmann::ordered_json& inputs, nlohmann::ordered_json& parameters) {
  rename_files(inputs, parameters, [&](const fs::path& name) { return named_from({}, place_of(folder, name)); });
}

}  // namespace rtusim
