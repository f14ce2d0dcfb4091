#include "modules/config/schema.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "modules/config/alternatives.h"
#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/config/toml.h"

namespace rtusim::config {
namespace {

using nlohmann::ordered_json;

constexpr std::string_view errata_section = "errata";
constexpr std::string_view all_errata = "errata.all";
constexpr std::string_view default_word = "default";
constexpr std::size_t most_toml_bytes = std::size_t{1} << 20;
constexpr std::size_t most_shown_bytes = 60;

template <class... F>
struct overloaded : F... {
  using F::operator()...;
};
template <class... F>
overloaded(F...) -> overloaded<F...>;

/// A text in quotes, on one line, whatever it holds; a long one cut between two characters.
std::string in_quotes(std::string_view text) {
  std::string shown = ordered_json(text.substr(0, 4 * most_shown_bytes)).dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  if (shown.size() <= most_shown_bytes) return shown;
  std::size_t cut = most_shown_bytes;
  while ((static_cast<unsigned char>(shown[cut]) & 0xC0U) == 0x80U) --cut;
  return shown.substr(0, cut) + "...";
}

/// A component of a key as TOML has it bare; any other in quotes, so that it matches no parameter. `also` is allowed too.
std::string component(std::string_view name, std::string_view also = {}) {
  const bool bare = !name.empty() && name.size() <= most_shown_bytes && std::all_of(name.begin(), name.end(), [&](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
           also.find(c) != std::string_view::npos;
  });
  return bare ? std::string(name) : in_quotes(name);
}

/// A value for an error message: `[1, 2, 3, ...]`.
std::string show(const ordered_json& value) {
  if (value.is_string()) return in_quotes(value.get_ref<const std::string&>());
  if (value.is_object()) return value.empty() ? "{}" : "{...}";
  if (value.is_number_float() && !std::isfinite(value.get<double>())) return fmt::format("{}", value.get<double>());
  if (!value.is_array()) return value.dump();
  std::string text;
  for (std::size_t i = 0; i < value.size() && i < 3; ++i) text += (i > 0 ? ", " : "") + (value[i].is_array() ? "[...]" : show(value[i]));
  return '[' + text + (value.size() > 3 ? ", ...]" : "]");
}

/// The parts of a value that a parameter can take or a message shows, however large and deep it is: no parameter takes a table,
/// a date, a nested array or an array of more than three.
ordered_json outline(const toml::node& node, bool inner = false) {
  if (const auto* v = node.as_string()) return v->get();
  if (const auto* v = node.as_integer()) return v->get();
  if (const auto* v = node.as_floating_point()) return v->get();
  if (const auto* v = node.as_boolean()) return v->get();
  if (const auto* v = node.as_table()) return v->empty() ? ordered_json::object() : ordered_json{{"", nullptr}};
  if (!node.is_array()) return nullptr;
  auto list = ordered_json::array();
  for (const auto& element : *node.as_array()) {
    if (inner || list.size() == 4) break;
    list.push_back(outline(element, true));
  }
  return list;
}

ordered_json outline(const nlohmann::json& value, bool inner = false) {
  if (value.is_object()) return value.empty() ? ordered_json::object() : ordered_json{{"", nullptr}};
  if (!value.is_array()) return value;
  auto list = ordered_json::array();
  for (const auto& element : value) {
    if (inner || list.size() == 4) break;
    list.push_back(outline(element, true));
  }
  return list;
}

std::string show(const toml::node& node) {
  std::ostringstream text;
  if (const auto* v = node.as_date())
    text << *v;
  else if (const auto* w = node.as_time())
    text << *w;
  else if (const auto* x = node.as_date_time())
    text << *x;
  else
    return show(outline(node));
  return text.str();
}

template <class T>
std::string range_text(const T& least, const T& most) {
  const bool from = std::is_unsigned_v<T> || (std::isfinite(static_cast<double>(least)) && least > std::numeric_limits<T>::lowest());
  const bool to = std::isfinite(static_cast<double>(most)) && most < std::numeric_limits<T>::max();
  if (from && to) return fmt::format(" from {} to {}", least, most);
  if (from) return fmt::format(" of at least {}", least);
  return to ? fmt::format(" of at most {}", most) : "";
}

template <class T>
std::string number_text(std::string_view noun, const range<T>& limits, const std::string& unit) {
  const auto values = range_text(limits.least, limits.most);
  return std::string(noun) + values + (unit.empty() ? "" : (values.empty() ? " of " : " ") + unit);
}

/// What values a parameter takes: "a whole number from 1 to 1024 cores".
std::string values_text(const parameter& p) {
  return std::visit(overloaded{
                        [&](const unsigned_slot& s) {
                          return number_text("a whole number", s.limits, p.unit) +
                                 (s.is_word != nullptr ? fmt::format(" or {}", s.word) : "");
                        },
                        [&](const flag_slot&) { return std::string("true or false"); },
                        [&](const real_slot& s) { return number_text("a finite number", s.limits, p.unit); },
                        [&](const text_slot&) { return std::string("a text in quotes"); },
                        [&](const vector_slot& s) { return number_text("an array of three finite numbers", s.limits, p.unit); },
                        [&](const choice_slot& s) { return alternatives(s.words); },
                    },
                    p.slot);
}

ordered_json value_of(const parameter& p) {
  return std::visit(overloaded{
                        [](const unsigned_slot& s) -> ordered_json {
                          if (s.is_word != nullptr && *s.is_word) return s.word;
                          return s.get(s.at);
                        },
                        [](const choice_slot& s) -> ordered_json { return s.words.at(s.get()); },
                        [](const auto& s) -> ordered_json { return *s.at; },
                    },
                    p.slot);
}

std::optional<std::uint64_t> whole_number(const ordered_json& value) {
  if (value.is_number_unsigned()) return value.get<std::uint64_t>();
  if (value.is_number_integer() && value.get<std::int64_t>() >= 0) return static_cast<std::uint64_t>(value.get<std::int64_t>());
  return {};
}

std::optional<double> real_number(const ordered_json& value, const range<double>& limits) {
  if (!value.is_number()) return {};
  const auto v = value.get<double>();
  return std::isfinite(v) && v >= limits.least && v <= limits.most ? std::optional(v) : std::nullopt;
}

/// A text that a JSON record and a path can hold.
bool is_plain_text(const ordered_json& value) {
  if (!value.is_string() || value.get_ref<const std::string&>().find('\0') != std::string::npos) return false;
  try {
    static_cast<void>(value.dump());
    return true;
  } catch (const ordered_json::type_error&) {
    return false;
  }
}

/// Stores `value` if the parameter takes it.
bool store(const parameter& p, const ordered_json& value) {
  return std::visit(overloaded{
                        [&](const unsigned_slot& s) {
                          const bool is_word = s.is_word != nullptr && value.is_string() && value.get_ref<const std::string&>() == s.word;
                          const auto v = whole_number(value);
                          if (!is_word && (!v || *v < s.limits.least || *v > s.limits.most)) return false;
                          if (s.is_word != nullptr) *s.is_word = is_word;
                          if (!is_word) s.set(s.at, *v);
                          return true;
                        },
                        [&](const flag_slot& s) {
                          if (value.is_boolean()) *s.at = value.get<bool>();
                          return value.is_boolean();
                        },
                        [&](const real_slot& s) {
                          const auto v = real_number(value, s.limits);
                          if (v) *s.at = *v;
                          return v.has_value();
                        },
                        [&](const text_slot& s) {
                          if (!is_plain_text(value)) return false;
                          *s.at = value.get<std::string>();
                          return true;
                        },
                        [&](const vector_slot& s) {
                          if (!value.is_array() || value.size() != s.at->size()) return false;
                          std::array<double, 3> read{};
                          for (std::size_t i = 0; i < read.size(); ++i) {
                            const auto v = real_number(value[i], s.limits);
                            if (!v) return false;
                            read[i] = *v;
                          }
                          *s.at = read;
                          return true;
                        },
                        [&](const choice_slot& s) {
                          if (!value.is_string()) return false;
                          const auto word = std::find(s.words.begin(), s.words.end(), value.get_ref<const std::string&>());
                          if (word == s.words.end()) return false;
                          s.set(static_cast<unsigned>(word - s.words.begin()));
                          return true;
                        },
                    },
                    p.slot);
}

/// ", or did you mean WORD?" for a misspelt choice, else nothing.
std::string near_word(const parameter& p, const ordered_json& value) {
  const auto* choice = std::get_if<choice_slot>(&p.slot);
  if (!choice || !value.is_string()) return {};
  const auto word = nearest(value.get_ref<const std::string&>(), {choice->words.begin(), choice->words.end()});
  return word.empty() ? "" : fmt::format("; did you mean {}?", word);
}

std::string section_of(const std::string& key) { return key.substr(0, key.find('.')); }

input_error unknown_key(const std::string& place, const std::string& key, const std::vector<std::string>& candidates) {
  const auto near = nearest(key, candidates);
  return {place, "unknown key " + key, near.empty() ? "one of the keys that 'rtusim explain' lists" : near};
}

/// Whether `key` is `prefix` or begins with all of its components.
bool starts_key(std::string_view key, std::string_view prefix) {
  return prefix.empty() || key == prefix || (key.substr(0, prefix.size()) == prefix && key.substr(prefix.size(), 1) == ".");
}

}  // namespace

/// One value on its way to a parameter.
struct schema::assignment {
  std::string key;     // as it was written
  std::string target;  // the key or alias of its parameter: `key`, except for a field of an entry
  ordered_json value;
  std::string shown;  // the value as a message shows it
  std::string place;
};

/// Turns a TOML document, or one value of it, into assignments.
struct schema::toml_reader {
  const schema& into;
  std::string file;
  bool has_lines;
  std::vector<std::pair<toml::source_position, assignment>> found;

  std::string place(const toml::source_position& at) const { return has_lines ? fmt::format("{}:{}", file, at.line) : file; }

  void add(const std::string& key, const std::string& target, const toml::node& node, const toml::source_position& at) {
    found.push_back({at, {key, target, outline(node), show(node), place(at)}});
  }

  /// A node under `key`, whose components number `depth`; what lies deeper than SECTION.FIELD is told by its first key alone.
  void read(const std::string& key, unsigned depth, const toml::node& node, const toml::source_position& at) {
    const auto* table = node.as_table();
    const auto form = into.entry_forms_.find(key);
    if (table && !table->empty() && depth < 3) {
      for (const auto& [name, value] : *table) {
        read(key + '.' + component(name.str()), depth + 1, value, name.source().begin);
        if (depth == 2) break;
      }
    } else if (form != into.entry_forms_.end() && node.is_array()) {
      read_entry(key, form->second, *node.as_array(), at);
    } else {
      add(key, key, node, at);
    }
  }

  void read_entry(const std::string& key, const entry& form, const toml::array& entries, const toml::source_position& at) {
    const auto expected = fmt::format("one [[{}]] entry", key);
    if (entries.size() != 1)
      throw input_error(place(at), fmt::format("{} entries [[{}]], but {}", entries.size(), key, form.why_one), expected);
    const auto* fields = entries[0].as_table();
    if (!fields) throw input_error(place(at), fmt::format("{} = {}", key, show(entries)), expected);
    std::vector<std::string> names;
    for (const auto& [name, target] : form.fields) names.push_back(key + '.' + name);
    for (const auto& [name, value] : *fields) {
      const auto full = key + '.' + component(name.str());
      const auto field = form.fields.find(std::string(name.str()));
      if (field == form.fields.end()) throw unknown_key(place(name.source().begin), full, names);
      add(full, field->second, value, name.source().begin);
    }
  }

  /// In the order of the file.
  std::vector<assignment> assignments() {
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<assignment> list;
    for (auto& [at, a] : found) list.push_back(std::move(a));
    return list;
  }
};

void schema::note_defaults(const section& s, std::size_t first) {
  for (std::size_t i = first; i < s.parameters().size(); ++i) {
    const parameter& p = s.parameters()[i];
    RTU_CHECK(defaults_.count(p.key), ==, 0U);
    defaults_[p.key] = value_of(p);
  }
}

void schema::entry_form(std::string key, std::map<std::string, std::string> fields, std::string why_one) {
  entry_forms_[std::move(key)] = {std::move(fields), std::move(why_one)};
}

section& schema::place_for(std::string_view name, std::string_view after) {
  const auto named = [this](std::string_view n) {
    return std::find_if(sections_.begin(), sections_.end(), [n](const section& s) { return s.name() == n; });
  };
  if (const auto there = named(name); there != sections_.end()) return *there;
  const auto before = after.empty() ? sections_.end() : named(after);
  return *sections_.emplace(before == sections_.end() ? before : std::next(before), std::string(name));
}

parameter* schema::find(std::string_view key) {
  for (auto& s : sections_)
    for (auto& p : s.parameters())
      if (p.key == key || (!p.alias.empty() && p.alias == key)) return &p;
  return nullptr;
}

std::vector<std::string> schema::keys() const {
  std::vector<std::string> all;
  for (const auto& s : sections_)
    for (const auto& p : s.parameters()) {
      all.push_back(p.key);
      if (!p.alias.empty()) all.push_back(p.alias);
    }
  for (const auto& p : all)
    if (starts_key(p, errata_section)) {
      all.emplace_back(all_errata);
      break;
    }
  return all;
}

std::set<std::string> schema::sections_of(std::string_view kind) const {
  std::set<std::string> names;
  for (const auto& s : sections_) {
    const std::string& home = homes_.at(s.name());
    if (home.empty() || home == kind) names.insert(s.name());
  }
  return names;
}

void schema::read_toml(const std::filesystem::path& file, std::string_view kind) {
  const auto text = read_file(file, most_toml_bytes);
  if (text.find('\0') != text.npos) throw input_error(file.string(), "a binary file", "a TOML file");
  const auto document = parse_toml(text, file.string());
  toml_reader reader{*this, file.string(), true, {}};
  for (const auto& [name, value] : document) reader.read(component(name.str()), 1, value, name.source().begin);
  const std::set<std::string> sections = sections_of(kind);
  apply(reader.assignments(), &sections);
}

void schema::read_json(const nlohmann::json& values, const std::string& place) {
  if (!values.is_object()) throw input_error(place, show(outline(values)), "an object of parameters by section");
  std::vector<assignment> assignments;
  const auto add = [&](const std::string& key, const nlohmann::json& value) {
    const auto kept = outline(value);
    assignments.push_back({key, key, kept, show(kept), place});
  };
  for (const auto& [name, fields] : values.items()) {
    if (!fields.is_object() || fields.empty())
      add(component(name), fields);
    else
      for (const auto& [field, value] : fields.items()) add(component(name) + '.' + component(field), value);
  }
  apply(std::move(assignments), nullptr);
}

void schema::set(std::string_view assignment_text) {
  const std::string place = "--set";
  const auto equals = assignment_text.find('=');
  if (equals == std::string_view::npos || equals == 0) throw input_error(place, in_quotes(assignment_text), "KEY=VALUE");
  const auto trimmed = [](std::string_view text) {
    const auto first = text.find_first_not_of(" \t");
    return first == std::string_view::npos ? std::string_view{} : text.substr(first, text.find_last_not_of(" \t") - first + 1);
  };
  const auto key = component(trimmed(assignment_text.substr(0, equals)), ".");
  const auto text = trimmed(assignment_text.substr(equals + 1));
  if (text == default_word) return forget_all(key);
  const auto* p = find(key);
  const bool takes_text = p && std::holds_alternative<text_slot>(p->slot);
  toml::table document;
  try {
    document = parse_toml("value = " + std::string(text), place);
  } catch (const input_error&) {  // a bare word
    document.insert("value", text);
  }
  const auto* value = document.get("value");
  if (document.size() != 1 || (takes_text && !value->is_string())) return apply({{key, key, text, in_quotes(text), place}}, nullptr);
  toml_reader reader{*this, place, false, {}};
  reader.read(key, static_cast<unsigned>(1 + std::count(key.begin(), key.end(), '.')), *value, {});
  apply(reader.assignments(), nullptr);
}

void schema::apply(std::vector<assignment> assignments, const std::set<std::string>* allowed) {
  std::stable_partition(assignments.begin(), assignments.end(), [](const assignment& a) { return a.target == all_errata; });
  std::map<std::string, std::string> places;  // by key
  for (const auto& a : assignments) {
    if (a.target == all_errata) {
      set_all_errata(a, allowed);
      continue;
    }
    const auto* p = find(a.target);
    if (!p) {
      refuse_unknown(a, allowed);
      continue;
    }
    check_home(a, section_of(p->key), allowed);
    const auto [earlier, is_first] = places.emplace(p->key, a.place);
    if (!is_first) throw input_error(a.place, fmt::format("{} was given before, at {}", a.key, earlier->second), "it once");
    if (!store(*p, a.value)) throw input_error(a.place, a.key + " = " + a.shown, values_text(*p) + near_word(*p, a.value));
    given_[p->key] = {a.place, a.key};
  }
}

void schema::set_all_errata(const assignment& a, const std::set<std::string>* allowed) {
  const parameter* other = nullptr;  // an erratum that does not belong in this file
  bool is_known = false;
  for (auto& s : sections_)
    for (const auto& p : s.parameters()) {
      if (p.alias.empty()) continue;
      if (allowed && allowed->count(s.name()) == 0) {
        other = &p;
        continue;
      }
      is_known = true;
      if (!store(p, a.value)) throw input_error(a.place, a.key + " = " + a.shown, values_text(p));
    }
  if (is_known) return;
  if (other) check_home(a, section_of(other->key), allowed);
  throw unknown_key(a.place, a.key, keys());
}

void schema::check_home(const assignment& a, const std::string& section_name, const std::set<std::string>* allowed) const {
  if (!allowed || allowed->count(section_name) > 0) return;
  std::set<std::string> names = *allowed;
  for (const auto& s : sections_)
    for (const auto& p : s.parameters())
      if (!p.alias.empty() && allowed->count(s.name()) > 0) names.emplace(errata_section);
  throw input_error(a.place, a.key + " belongs in " + homes_.at(section_name), "keys of " + alternatives(names));
}

/// For a key that is no parameter's: fine when it is an empty table `[section]`, else an error.
void schema::refuse_unknown(const assignment& a, const std::set<std::string>* allowed) const {
  const auto name = section_of(a.target);
  const auto all = keys();
  const bool is_section = homes_.count(name) > 0;
  if (is_section) check_home(a, name, allowed);
  const bool has_keys = is_section || (name == errata_section && std::find(all.begin(), all.end(), all_errata) != all.end());
  if (a.target != name) throw unknown_key(a.place, a.key, all);
  if (!has_keys) {
    std::vector<std::string> names = all;
    for (const auto& [section_name, home] : homes_) names.push_back(section_name);
    throw unknown_key(a.place, a.key, names);
  }
  if (!a.value.is_object()) throw input_error(a.place, a.key + " = " + a.shown, fmt::format("keys of the section [{}]", name));
}

void schema::read_when(const std::vector<std::string>& names, const std::function<bool()>& condition, const std::string& words) {
  const auto named = [&names](const std::string& name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  for (auto& s : sections_) {
    for (auto& p : s.parameters()) {
      if (!named(s.name()) && !named(p.key)) continue;
      const auto own = p.is_read;
      p.when([condition, own] { return condition() && (!own || own()); }, p.read_when.empty() ? words : words + " and " + p.read_when);
    }
  }
}

void schema::forget(std::string_view key) {
  const parameter* p = find(key);
  RTU_CHECK(p != nullptr, ==, true);
  store(*p, defaults_.at(p->key));
  given_.erase(p->key);
}

/// What `KEY=default` of a command line asks for.
void schema::forget_all(std::string_view key) {
  if (key == all_errata) {
    for (const auto& s : sections_)
      for (const auto& p : s.parameters())
        if (!p.alias.empty()) forget(p.key);
  } else if (find(key) != nullptr) {
    forget(key);
  } else {
    throw unknown_key("--set", std::string(key), keys());
  }
}

void schema::check_read() const {
  for (const auto& s : sections_)
    for (const auto& p : s.parameters()) {
      const auto given = given_.find(p.key);
      if (given == given_.end() || !p.is_read || p.is_read()) continue;
      throw input_error(given->second.place, given->second.key + " is not read by this design", "it only when " + p.read_when);
    }
}

bool schema::leaves_unread(const std::filesystem::path& file) const {
  const auto of_file = file.string() + ':';
  for (const auto& s : sections_)
    for (const auto& p : s.parameters()) {
      const auto given = given_.find(p.key);
      if (given != given_.end() && p.is_read && !p.is_read() && given->second.place.rfind(of_file, 0) == 0) return true;
    }
  return false;
}

nlohmann::ordered_json schema::values() const {
  auto record = ordered_json::object();
  for (const auto& s : sections_) {
    // Made as an object: a null that becomes one while memory runs out is left in a state that can't be destroyed.
    auto of_section = ordered_json::object();
    for (const auto& p : s.parameters())
      if (!p.is_read || p.is_read()) of_section[p.key.substr(s.name().size() + 1)] = value_of(p);
    if (!of_section.empty()) record[s.name()] = std::move(of_section);
  }
  return record;
}

std::string schema::explain(std::string_view key) const {
  std::string text = explanation_text(explanations([key](std::string_view k) { return starts_key(k, key); }));
  if (!text.empty()) return text;
  auto candidates = keys();
  for (const auto& [name, home] : homes_) candidates.push_back(name);
  throw unknown_key("explain", component(key, "."), candidates);
}

std::string schema::explain_all_with(std::string_view part) const {
  return explanation_text(explanations([part](std::string_view k) { return k.find(part) != k.npos; }));
}

std::vector<explanation> schema::explanations(const std::function<bool(std::string_view)>& is_wanted) const {
  std::vector<explanation> rows;
  std::vector<std::string> errata;
  for (const auto& s : sections_)
    for (const auto& p : s.parameters()) {
      if (!p.alias.empty()) errata.push_back(p.alias);
      if (!is_wanted(p.key) && (p.alias.empty() || !is_wanted(p.alias))) continue;
      const auto& preset = defaults_.at(p.key);
      const bool is_bare = preset.is_string() && !preset.get_ref<const std::string&>().empty();
      rows.push_back({p.key, is_bare ? preset.get<std::string>() : preset.dump(), values_text(p), p.meaning, {}});
      auto& notes = rows.back().notes;
      if (!p.alias.empty()) notes.push_back("also: " + p.alias);
      if (const auto form = entry_forms_.find(p.key); form != entry_forms_.end()) {
        std::vector<std::string> parts;
        for (const auto& [field, target] : form->second.fields) parts.push_back(fmt::format("{} ({})", field, target));
        notes.push_back(fmt::format("in a file also: one table [[{}]] with {}", p.key, fmt::join(parts, ", ")));
      }
      if (!p.read_when.empty()) notes.push_back("read only when " + p.read_when);
    }
  if (!errata.empty() && is_wanted(all_errata))
    rows.push_back(
        {std::string(all_errata), "", "true or false", fmt::format("sets {}; one named by itself wins", fmt::join(errata, ", ")), {}});
  return rows;
}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const auto& candidate : candidates) {
    const std::size_t longer = std::max(word.size(), candidate.size());
    if (longer - std::min(word.size(), candidate.size()) > longer / 3) continue;
    std::vector<std::size_t> before, last, row(candidate.size() + 1);  // of the table of distances between prefixes
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= word.size(); ++i) {
      before = std::exchange(last, row);
      row[0] = i;
      for (std::size_t j = 1; j <= candidate.size(); ++j) {
        row[j] = std::min({last[j - 1] + (word[i - 1] == candidate[j - 1] ? 0 : 1), last[j] + 1, row[j - 1] + 1});
        if (i > 1 && j > 1 && word[i - 1] == candidate[j - 2] && word[i - 2] == candidate[j - 1])
          row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    if (row.back() <= longer / 3 && row.back() < least) {
      least = row.back();
      best = candidate;
    }
  }
  return best;
}

}  // namespace rtusim::config
