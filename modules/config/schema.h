#pragma once

#include <deque>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "modules/config/section.h"

namespace rtusim::config {

/// Every parameter of a run: the sections that the units, the testbench and the scene described, and where their values came from.
///
/// Use: `add` all params; `read_toml` the files and `set` the overrides, in that order (the last one wins; an erratum named
/// by itself wins over `errata.all` of the same file or of an earlier place, whatever the order in the file); then `check_read`.
class schema {
 public:
  /// Describes `params` as a section. Its present values become the defaults.
  template <class Params>
  void add(std::string_view name, Params& params) {
    sections_.emplace_back(std::string(name));
    params.describe(sections_.back());
    note_defaults(sections_.back());
  }

  /// Reads a TOML file. `sections`: the top-level tables this file may hold (others are refused with a word on which kind
  /// of file they belong to when another section of that name exists).
  /// Errors: input_error for a file that is missing, a folder, unreadable or no TOML; for a key that nobody declares, naming
  /// the nearest one; for a value of the wrong type or out of range. Each with file and line.
  void read_toml(const std::filesystem::path& file, const std::set<std::string>& sections);

  /// Applies `KEY=VALUE` of a command line; VALUE is TOML, or a bare word for a choice or a text.
  void set(std::string_view assignment);

  /// After all values are in: refuses a key that was given by a file or by `set` but that this design does not read.
  void check_read() const;

  /// The values of all parameters that are read now, by section: `{"scheduler": {"policy": "..."}}`.
  nlohmann::ordered_json values() const;

  /// A table of the parameters whose key starts with `key` (all when empty): key, default, unit, range, meaning.
  /// Errors: input_error that names the nearest key when none matches.
  std::string explain(std::string_view key) const;

  const std::deque<section>& sections() const { return sections_; }

 private:
  struct origin { std::string place; std::string key; };  // where a value was given: "a.toml:7" or "--set"
  void note_defaults(const section& s);
  parameter* find(std::string_view key);

  std::deque<section> sections_;
  std::map<std::string, nlohmann::ordered_json> defaults_;  // by key
  std::map<std::string, origin> given_;                     // by key
};

/// The candidate with the least edit distance to `word`; empty when none is near.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace rtusim::config
