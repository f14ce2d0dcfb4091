#include "testbench/sweep/sweep_plan.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/config/toml.h"
#include "testbench/pictures/pictures.h"
#include "testbench/sweep/constraint.h"
#include "testbench/sweep/sweep_columns.h"

namespace rtusim {
namespace {

constexpr std::uint64_t most_file_bytes = std::uint64_t{1} << 20;
constexpr std::size_t most_shown_bytes = 60;
constexpr std::uint64_t usual_limit = 10'000, greatest_limit = 1'000'000;

/// A number in the fewest digits that tell it, a word as it stands.
std::string shown(const nlohmann::ordered_json& value) {
  if (value.is_string()) return value.get<std::string>();
  return value.is_number_float() ? fmt::format("{}", value.get<double>()) : value.dump();
}

}  // namespace

/// Turns a sweep file into a plan.
class sweep_reader {
 public:
  sweep_reader(sweep_plan& plan, const std::filesystem::path& file) : plan_(plan), file_(file) {
    const std::string text = config::read_file(file, most_file_bytes);
    const toml::table all = config::parse_toml(text, file.string());
    for (const auto& [name, node] : all) {
      const std::string_view key = name.str();
      if (key != "sweep" && key != "set" && key != "axes" && key != "in_step")
        fail(node, fmt::format("unknown section {}", key), "sweep, set, axes or in_step");
    }
    if (const auto* t = table(all, "sweep")) read_sweep(*t);
    if (const auto* t = table(all, "set")) read_set(*t);
    if (const auto* t = table(all, "axes"))
      for (const auto& [key, node] : keys_of(*t)) add_group({{key, values_of(key, *node)}}, *node);
    if (const auto* steps = all.get("in_step")) {
      const auto* list = steps->as_array();
      if (list == nullptr) fail(*steps, "in_step that is no array of tables", "[[in_step]]");
      for (const auto& entry : *list) read_step(entry);
    }
    if (plan_.scenes_.empty()) throw input_error(file_.string(), "no sweep.scenes", "a list of scene files");
    for (const auto* files : {&plan_.scenes_, &plan_.architectures_})
      for (const auto& f : *files)
        if (!std::filesystem::is_regular_file(plan_.place_of(f)))
          throw input_error(file_.string(), f + ", which is no file", "a path from the sweep file's folder");
    if (plan_.architectures_.empty()) plan_.architectures_.emplace_back();
    if (plan_.record_.empty()) plan_.record_ = usual_record();
    enumerate();
  }

 private:
  using keyed = std::pair<std::string, const toml::node*>;
  using column = std::pair<std::string, std::vector<sweep_plan::value>>;

  std::string place(const toml::node& node) const { return fmt::format("{}:{}", file_.string(), node.source().begin.line); }
  [[noreturn]] void fail(const toml::node& node, const std::string& found, const std::string& expected) const {
    throw input_error(place(node), found, expected);
  }
  const toml::table* table(const toml::table& all, std::string_view name) const {
    const toml::node* node = all.get(name);
    if (node != nullptr && !node->is_table()) fail(*node, fmt::format("{} that is no table", name), fmt::format("[{}]", name));
    return node == nullptr ? nullptr : node->as_table();
  }

  /// The entries of a table as SECTION.FIELD, in the order of the file, whether written as a dotted key or in quotes.
  std::vector<keyed> keys_of(const toml::table& t) const {
    std::vector<keyed> list;
    for (const auto& [name, node] : t) {
      const std::string key(name.str());
      const auto* inner = node.as_table();
      if (inner == nullptr || inner->contains("from") || key.find('.') != std::string::npos) {
        list.emplace_back(key, &node);
        continue;
      }
      for (const auto& [field, value] : *inner) list.emplace_back(key + '.' + std::string(field.str()), &value);
    }
    std::stable_sort(list.begin(), list.end(),
                     [](const keyed& a, const keyed& b) { return a.second->source().begin < b.second->source().begin; });
    return list;
  }

  std::vector<std::string> texts(const toml::node& node, const std::string& key) const {
    std::vector<std::string> list;
    const auto* array = node.as_array();
    if (array == nullptr) fail(node, key + " that is no list", "a list of texts");
    for (const auto& item : *array) {
      const auto text = item.value<std::string>();
      if (!text || text->empty()) fail(item, key + " with what is no text", "texts in quotes");
      list.push_back(*text);
    }
    if (list.empty()) fail(node, key + " = []", "at least one");
    return list;
  }

  void read_sweep(const toml::table& t) {
    for (const auto& [name, node] : t) {
      const std::string key(name.str());
      if (key == "scenes" || key == "architectures") {
        auto& files = key == "scenes" ? plan_.scenes_ : plan_.architectures_;
        for (const std::string& f : texts(node, key)) files.push_back(f);
      } else if (key == "constraints") {
        for (const std::string& text : texts(node, key)) constraints_.push_back(std::make_unique<constraint>(text, place(node)));
      } else if (key == "record") {
        plan_.record_ = texts(node, key);
        for (const std::string& figure : plan_.record_) check_figure(node, figure);
      } else if (key == "images") {
        plan_.images_ = texts(node, key);
        for (const std::string& ending : plan_.images_) kind_of("image." + ending);
      } else if (key == "limit") {
        const auto limit = node.value<std::int64_t>();
        if (!limit || *limit < 1 || *limit > static_cast<std::int64_t>(greatest_limit))
          fail(node, "limit that is no such number", fmt::format("a whole number from 1 to {}", greatest_limit));
        limit_ = static_cast<std::uint64_t>(*limit);
      } else {
        fail(node, "unknown key sweep." + key, "scenes, architectures, constraints, record, images or limit");
      }
    }
  }

  void read_set(const toml::table& t) {
    for (const auto& [key, node] : keys_of(t)) {
      check_key(*node, key);
      plan_.fixed_.push_back(one_value(key, *node).assignment);
    }
  }

  /// A key that no parameter has is the file's fault, not a point's.
  void check_key(const toml::node& node, const std::string& key) const {
    std::vector<std::string> keys;
    for (const column_meaning& p : parameters_) keys.push_back(p.name);
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) return;
    const std::string near = config::nearest(key, keys);
    fail(node, "unknown key " + key, near.empty() ? "one of the keys that 'rtusim explain' lists" : near);
  }

  void check_figure(const toml::node& node, const std::string& figure) const {
    std::vector<std::string> names;
    if (is_figure(figure, names)) return;
    const std::string near = config::nearest(figure, names);
    fail(node, "no figure " + figure.substr(0, most_shown_bytes),
         near.empty() ? "one that 'rtusim explain statistics' lists, without \"statistics.\"" : near);
  }

  static sweep_plan::value value_of(const std::string& key, const nlohmann::ordered_json& typed) {
    std::string text;
    if (typed.is_array()) {
      for (const auto& item : typed) text += (text.empty() ? "" : ", ") + shown(item);
      text = "[ " + text + " ]";
    } else {
      text = shown(typed);
    }
    return {key + '=' + text, text, typed};
  }

  sweep_plan::value one_value(const std::string& key, const toml::node& node) const {
    if (const auto* a = node.as_array(); a != nullptr && a->size() == 3) {
      nlohmann::ordered_json list = nlohmann::ordered_json::array();
      for (const auto& item : *a) list.push_back(single_value(key, item));
      return value_of(key, list);
    }
    return value_of(key, single_value(key, node));
  }

  nlohmann::ordered_json single_value(const std::string& key, const toml::node& node) const {
    if (const auto* v = node.as_string()) return v->get();
    if (const auto* v = node.as_integer()) return v->get();
    if (const auto* v = node.as_boolean()) return v->get();
    if (const auto* v = node.as_floating_point()) return v->get();
    fail(node, key + " with what is no value", "a number, a word, true, false or three numbers");
  }

  std::vector<sweep_plan::value> values_of(const std::string& key, const toml::node& node) const {
    std::vector<sweep_plan::value> values;
    if (const auto* range = node.as_table()) return values_of_range(key, *range);
    const auto* array = node.as_array();
    if (array == nullptr) fail(node, key + " without a list", "a list of values, or {from = .., to = .., step or factor = ..}");
    for (const auto& item : *array) values.push_back(one_value(key, item));
    if (values.empty()) fail(node, key + " = []", "at least one value");
    return values;
  }

  std::vector<sweep_plan::value> values_of_range(const std::string& key, const toml::table& range) const {
    for (const auto& [name, node] : range)
      if (const std::string_view n = name.str(); n != "from" && n != "to" && n != "step" && n != "factor")
        fail(node, fmt::format("{} with a range that has {}", key, n), "from, to, step or factor");
    const auto number = [&](const char* name) -> std::optional<double> {
      const toml::node* node = range.get(name);
      if (node == nullptr) return {};
      const auto v = node->value<double>();
      if (!v || !std::isfinite(*v)) fail(*node, fmt::format("{}: {} that is no number", key, name), "a number");
      return v;
    };
    const auto from = number("from"), to = number("to"), step = number("step"), factor = number("factor");
    const char* const form = "{from = .., to = ..} with step above 0 or factor above 1";
    if (!from || !to || (step && factor)) fail(range, key + " with a range that is none", form);
    if (*to < *from || (step && *step <= 0) || (factor && (*factor <= 1 || *from <= 0)))
      fail(range, key + " with a range that never ends", form);
    const bool whole =
        range.get("from")->is_integer() && (!step || range.get("step")->is_integer()) && (!factor || range.get("factor")->is_integer());
    const double count = factor ? std::log(*to / *from) / std::log(*factor) : (*to - *from) / step.value_or(1);
    if (count >= static_cast<double>(greatest_limit))
      fail(range, fmt::format("{} with {:.0f} values", key, count), fmt::format("at most {}", greatest_limit));
    std::vector<sweep_plan::value> values;
    const auto steps = static_cast<std::uint64_t>(count + 1e-9);
    for (std::uint64_t i = 0; i <= steps; ++i) {
      const double v = factor ? *from * std::pow(*factor, static_cast<double>(i)) : *from + static_cast<double>(i) * step.value_or(1);
      if (whole)
        values.push_back(value_of(key, static_cast<std::int64_t>(std::llround(v))));
      else
        values.push_back(value_of(key, std::stod(fmt::format("{:.12g}", v))));  // 0.3, and not 0.30000000000000004
    }
    return values;
  }

  void read_step(const toml::node& entry) {
    const auto* t = entry.as_table();
    if (t == nullptr || t->empty()) fail(entry, "in_step that is no table, or an empty one", "keys with lists of as many values");
    std::vector<column> columns;
    for (const auto& [key, node] : keys_of(*t)) {
      columns.emplace_back(key, values_of(key, *node));
      if (columns.back().second.size() != columns.front().second.size())
        fail(*node, fmt::format("{} values of {}", columns.back().second.size(), key),
             fmt::format("{}, as of {}", columns.front().second.size(), columns.front().first));
    }
    add_group(columns, entry);
  }

  void add_group(const std::vector<column>& columns, const toml::node& node) {
    sweep_plan::axis_group group;
    group.rows.resize(columns.front().second.size());
    for (const auto& [key, values] : columns) {
      check_key(node, key);
      if (std::find(plan_.keys_.begin(), plan_.keys_.end(), key) != plan_.keys_.end()) fail(node, "a second axis " + key, "each key once");
      plan_.keys_.push_back(key);
      for (std::size_t i = 0; i < values.size(); ++i) group.rows[i].push_back(values[i]);
    }
    plan_.groups_.push_back(std::move(group));
  }

  void enumerate() {
    double count = static_cast<double>(plan_.scenes_.size()) * static_cast<double>(plan_.architectures_.size());
    for (const auto& group : plan_.groups_) count *= static_cast<double>(group.rows.size());
    if (count > static_cast<double>(limit_))
      throw input_error(file_.string(), fmt::format("{:.0f} points", count),
                        fmt::format("at most sweep.limit = {}: set that if so many are meant", limit_));
    std::vector<std::size_t> turn(plan_.groups_.size(), 0);
    for (std::size_t scene = 0; scene < plan_.scenes_.size(); ++scene)
      for (std::size_t architecture = 0; architecture < plan_.architectures_.size(); ++architecture)
        for (bool more = true; more;) {
          sweep_plan::point p{scene, architecture, {}};
          for (std::size_t g = 0; g < turn.size(); ++g)
            for (const auto& v : plan_.groups_[g].rows[turn[g]]) p.values.push_back(&v);
          add(std::move(p));
          more = false;
          for (std::size_t g = turn.size(); g-- > 0 && !more;) {
            turn[g] = turn[g] + 1 < plan_.groups_[g].rows.size() ? turn[g] + 1 : 0;
            more = turn[g] != 0;
          }
        }
    if (plan_.points_.empty()) throw input_error(file_.string(), "no point that the constraints allow", "at least one");
  }

  void add(sweep_plan::point p) {
    if (!constraints_.empty()) {
      // A design that can't be is a point with its reason, whatever the constraints.
      std::unique_ptr<run_setup> s;
      try {
        s = plan_.setup(p);
      } catch (const input_error&) {}
      if (s) {
        const auto parameters = s->parameters.values();
        if (!std::all_of(constraints_.begin(), constraints_.end(), [&](const auto& c) { return c->allows(parameters); })) {
          ++plan_.left_out_;
          return;
        }
      }
    }
    plan_.points_.push_back(std::move(p));
  }

  sweep_plan& plan_;
  std::filesystem::path file_;
  const std::vector<column_meaning> parameters_ = all_axes();
  std::uint64_t limit_ = usual_limit;
  std::vector<std::unique_ptr<constraint>> constraints_;
};

sweep_plan::sweep_plan(const std::filesystem::path& file) : folder_(std::filesystem::absolute(file).parent_path()) {
  sweep_reader(*this, file);
}

std::string sweep_plan::named_as_written(std::string text) const {
  const std::string start = (folder_ / "").string();
  if (start == "/") return text;
  for (std::size_t at = text.find(start); at != std::string::npos; at = text.find(start, at)) text.erase(at, start.size());
  return text;
}

std::unique_ptr<run_setup> sweep_plan::setup(const point& p) const {
  run_sources from{scene(p), architecture(p), fixed_, {}};
  for (const value* v : p.values) from.assignments.push_back(v->assignment);
  return std::make_unique<run_setup>(from);
}

}  // namespace rtusim
