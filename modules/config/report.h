#pragma once

#include <cstdint>
#include <string>
#include <string_view>
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

  explicit report(std::string name = {}) : prefix_(std::move(name)) {}

  template <class Value>
  void number(std::string_view field, const Value& value, std::string_view unit, std::string_view meaning) {
    entries_.push_back({key(field), std::string(unit), std::string(meaning)});
    values_[std::string(field)] = value;
  }
  /// A nested object; `fill` describes it into the report it is given.
  template <class Fill>
  void group(std::string_view field, Fill&& fill) {
    report inner(key(field));
    fill(inner);
    values_[std::string(field)] = std::move(inner.values_);
    for (auto& e : inner.entries_) entries_.push_back(std::move(e));
  }

  const nlohmann::ordered_json& values() const { return values_; }
  const std::vector<entry>& entries() const { return entries_; }

 private:
  std::string key(std::string_view field) const { return prefix_.empty() ? std::string(field) : prefix_ + '.' + std::string(field); }

  std::string prefix_;
  nlohmann::ordered_json values_ = nlohmann::ordered_json::object();
  std::vector<entry> entries_;
};

}  // namespace rtusim::config
