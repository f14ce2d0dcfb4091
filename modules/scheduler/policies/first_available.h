#pragma once

#include <string_view>

#include "modules/scheduler/policies/any_ready_core.h"

namespace rtusim {

/// Cores in the order of their indices.
class order_of_indices {
 public:
  explicit order_of_indices(unsigned) {}

  template <class Lines>
  unsigned first(const Lines& ready) const {
    return ready.lowest();
  }
  void took(unsigned) {}
};

/// No select; of the cores that are ready, the one with the lowest index.
class first_available : public any_ready_core<order_of_indices> {
 public:
  static constexpr std::string_view name = "first_available";
  static constexpr std::string_view meaning = "the ready core with the lowest index";

  using any_ready_core::any_ready_core;
};

}  // namespace rtusim
