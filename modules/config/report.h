#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace rtusim::config {

/// The list into which a `stats` struct describes its figures: each one's name, value, unit and meaning.
///
///     void describe(config::report& r) const {
///       r.number("jobs", jobs, "jobs", "jobs handed to a core");
///       r.group("wait", [&](config::report& g) { ... });
///     }
///
/// From one such list come the statistics file (`values`) and the statistics part of `rtusim explain` (`entries`).
/// The order of the description is the order in the file.
class report {
 public:
  struct entry {
    std::string key;  ///< `scheduler.jobs`
    std::string unit;
    std::string meaning;
  };

  /// What is asked for: values alone take a third of the time.
  enum class wants : std::uint8_t { all, values };

  explicit report(std::string name = {}, wants what = wants::all) : prefix_(std::move(name)), what_(what) {}

  template <class Value>
  void number(std::string_view field, const Value& value, std::string_view unit, std::string_view meaning) {
    if (what_ == wants::all) entries_.push_back({key(field), std::string(unit), std::string(meaning)});
    add(field, value);
  }
  /// A nested object; `fill` describes it into the report it is given.
  template <class Fill>
  void group(std::string_view field, Fill&& fill) {
    report inner(what_ == wants::all ? key(field) : std::string(), what_);
    fill(inner);
    add(field, std::move(inner.values_));
    for (auto& e : inner.entries_) entries_.push_back(std::move(e));
  }

  const nlohmann::ordered_json& values() const& { return values_; }
  nlohmann::ordered_json values() && { return std::move(values_); }
  const std::vector<entry>& entries() const { return entries_; }

 private:
  /// A field has not been there before, so none is looked for.
  template <class Value>
  void add(std::string_view field, Value&& value) {
    values_.get_ref<nlohmann::ordered_json::object_t&>().emplace_back(std::string(field), std::forward<Value>(value));
  }
  std::string key(std::string_view field) const { return prefix_.empty() ? std::string(field) : prefix_ + '.' + std::string(field); }

  std::string prefix_;
  wants what_;
  nlohmann::ordered_json values_ = nlohmann::ordered_json::object();
  std::vector<entry> entries_;
};

}  // namespace rtusim::config
