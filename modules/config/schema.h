#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <list>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "modules/config/explanation.h"
#include "modules/config/section.h"

namespace rtusim::config {

/// Every parameter of a run: the sections that the units, the testbench and the scene described, and where their values came from.
///
/// Use: `add` all params; `read_toml` the files and `set` the overrides, in that order (the last one wins; an erratum named
/// by itself wins over `errata.all` of the same file or of an earlier place, whatever the order in the file); then `check_read`.
class schema {
 public:
  /// Describes `params` as a section, or as more of one. Its present values become the defaults.
  /// `home`: the kind of file its keys stand in, "a scene file"; empty: they stand in any. `after`: the section after which a new one
  /// stands in records; at the end if empty.
  template <class Params>
  void add(std::string_view name, Params& params, std::string_view home = {}, std::string_view after = {}) {
    section& s = place_for(name, after);
    const std::size_t before = s.parameters().size();
    params.describe(s);
    note_defaults(s, before);
    homes_[std::string(name)] = home;
  }

  /// These parameters, and those of these sections, are read only while `condition` holds, on top of their own conditions; `words` says
  /// when.
  void read_when(const std::vector<std::string>& keys_or_sections, const std::function<bool()>& condition, const std::string& words);

  /// Lets the parameter `key` also be given as an array of tables with one entry, whose fields stand for other parameters:
  /// after `entry_form("rtu.core", {{"kind", "rtu.core"}, {"count", "rtu.cores"}})` the entry `[[rtu.core]]` with `kind` and
  /// `count` is the long form of `rtu.core` and `rtu.cores`. `why_one`: why a second entry is refused.
  void entry_form(std::string key, std::map<std::string, std::string> fields, std::string why_one = "this version takes one");

  /// Reads a TOML file of a kind: it may hold the sections whose home it is, those without one, and `[errata]`.
  /// Errors: input_error for a file that is missing, a folder, unreadable, larger than 1 MiB or no TOML; for a key that nobody
  /// declares, naming the nearest one; for a section of another kind of file; for a parameter given twice; for a value of the
  /// wrong type or out of range. Each with file and line.
  void read_toml(const std::filesystem::path& file, std::string_view kind);
  /// Applies a record that `values` gave; `place` names its source in errors, which are those of `read_toml`.
  void read_json(const nlohmann::json& values, const std::string& place);

  /// Applies `KEY=VALUE` of a command line; VALUE is TOML, or a bare word for a choice or a text. A text takes anything that is
  /// not a TOML string as it stands. The bare word `default` gives a parameter, or all errata, its default again, as if no file had
  /// named it: what then is not read need not be taken out of a file.
  void set(std::string_view assignment);

  /// Gives a parameter its default again, as if no file had named it.
  void forget(std::string_view key);

  /// After all values are in: refuses a key that was given by a file or by `set` but that this design does not read.
  void check_read() const;

  /// Whether this file gave a value that this design does not read.
  bool leaves_unread(const std::filesystem::path& file) const;

  /// The values of all parameters that are read now, by section: `{"scheduler": {"policy": "..."}}`.
  nlohmann::ordered_json values() const;

  /// A table of the parameters whose key starts with `key` (all when empty): key, default, unit, range, meaning.
  /// Errors: input_error that names the nearest key when none matches.
  std::string explain(std::string_view key) const;
  /// The same of the parameters whose key holds `part` anywhere; empty when there are none.
  std::string explain_all_with(std::string_view part) const;

  /// Of the parameters whose key, or alias, is wanted, in their order.
  std::vector<explanation> explanations(const std::function<bool(std::string_view)>& is_wanted) const;

  const std::list<section>& sections() const { return sections_; }

 private:
  struct origin {
    std::string place;
    std::string key;
  };  // where a value was given: "a.toml:7" or "--set"
  struct entry {
    std::map<std::string, std::string> fields;
    std::string why_one;
  };
  struct assignment;
  struct toml_reader;
  section& place_for(std::string_view name, std::string_view after);
  void note_defaults(const section& s, std::size_t first);
  parameter* find(std::string_view key);
  void apply(std::vector<assignment> assignments, const std::set<std::string>* allowed);
  void forget_all(std::string_view key);
  void set_all_errata(const assignment& a, const std::set<std::string>* allowed);
  void refuse_unknown(const assignment& a, const std::set<std::string>* allowed) const;
  void check_home(const assignment& a, const std::string& section_name, const std::set<std::string>* allowed) const;
  std::vector<std::string> keys() const;
  std::set<std::string> sections_of(std::string_view kind) const;

  std::list<section> sections_;
  std::map<std::string, std::string> homes_;                // by section
  std::map<std::string, entry> entry_forms_;                // by key
  std::map<std::string, nlohmann::ordered_json> defaults_;  // by key
  std::map<std::string, origin> given_;                     // by key
};

/// The candidate with the least edit distance to `word`, in which two neighbours that changed places count once; empty when none is near
/// (within a third of the longer one's length).
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace rtusim::config
