#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "modules/config/report.h"

namespace rtusim {

/// What a unit has counted.
class unit_figures {
 public:
  virtual ~unit_figures() = default;
  virtual void describe(config::report& r) const = 0;
  /// The name under which those of several units are added up; empty: they are not.
  virtual std::string_view sum_name() const = 0;
  /// Adds to `sum`, which is null at first, or of this class.
  virtual void add_to(std::unique_ptr<unit_figures>& sum) const = 0;
  /// Appends what was lost or changed, a sentence each.
  virtual void warn(std::vector<std::string>& all) const = 0;
};

/// A `stats` struct as figures: it has `describe(report)`; with a `sum_name` and `+=` it is added up; with `warn(sentences)` it warns.
template <class Stats>
class figures_of final : public unit_figures {
 public:
  explicit figures_of(Stats s) : stats_(std::move(s)) {}

  void describe(config::report& r) const override { stats_.describe(r); }
  std::string_view sum_name() const override {
    if constexpr (is_summed<Stats>::value)
      return Stats::sum_name;
    else
      return {};
  }
  void add_to(std::unique_ptr<unit_figures>& sum) const override {
    if constexpr (is_summed<Stats>::value) {
      if (!sum) sum = std::make_unique<figures_of>(Stats{});
      dynamic_cast<figures_of&>(*sum).stats_ += stats_;
    }
  }
  void warn(std::vector<std::string>& all) const override {
    if constexpr (warns<Stats>::value) stats_.warn(all);
  }

 private:
  template <class S, class = void>
  struct is_summed : std::false_type {};
  template <class S>
  struct is_summed<S, std::void_t<decltype(S::sum_name)>> : std::true_type {};
  template <class S, class = void>
  struct warns : std::false_type {};
  template <class S>
  struct warns<S, std::void_t<decltype(&S::warn)>> : std::true_type {};

  Stats stats_;
};

template <class Stats>
std::unique_ptr<unit_figures> as_figures(Stats s) {
  return std::make_unique<figures_of<Stats>>(std::move(s));
}

/// Those of a unit under its instance's name.
struct named_figures {
  std::string name;
  std::shared_ptr<const unit_figures> figures;
};

/// Describes each as a group; before the first of those that are added up, their sum.
void describe(const std::vector<named_figures>& units, config::report& r);

}  // namespace rtusim
