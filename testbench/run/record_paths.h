#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

namespace rtusim {

/// The folder from which a record names files: the one that the record itself lies in, links followed; empty for what lies in no folder
/// (a pipe, a terminal), from where files are named in full.
std::filesystem::path folder_of_record(const std::filesystem::path& record);

/// A file as seen from a folder, `../models/a.svo`, whatever the current directory. Links to folders are followed, so that `..` leads to
/// the same place for everybody; the file's own name stays. In full where `folder` is empty. An empty name stays empty.
std::filesystem::path named_from(const std::filesystem::path& folder, const std::filesystem::path& file);

/// Where a file lies that a record in `folder` names so. An empty name stays empty.
std::filesystem::path place_of(const std::filesystem::path& folder, const std::filesystem::path& name);

/// Names all files of a record's parts `inputs` and `parameters` from a folder, `named_from`.
void name_files_from(const std::filesystem::path& folder, nlohmann::ordered_json& inputs, nlohmann::ordered_json& parameters);

/// The contrary: names the files of a record in `folder` in full, so that records of several folders can be compared.
void name_files_in_full(const std::filesystem::path& folder, nlohmann::ordered_json& inputs, nlohmann::ordered_json& parameters);

}  // namespace rtusim
