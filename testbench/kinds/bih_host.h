#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "modules/bih_core/bih_kind.h"
#include "testbench/kinds/driver.h"
#include "testbench/kinds/host_kind.h"

namespace rtusim {

/// How the host builds hierarchies for triangle cores.
struct bih_builder_params {
  unsigned leaf_triangles = 8;

  void describe(config::section& s);
};

/// The host's side of triangle cores.
class bih_host final : public host_kind {
 public:
  std::string_view word() const override { return bih_kind::name; }
  void describe(config::schema& s, const std::function<bool()>& is_chosen) override;
  std::unique_ptr<loaded_model> load(const design& d, const scene& what) const override;
  std::vector<lone_unit> units() const override;
  std::vector<std::string> timing_only() const override;
  host_figures blank_figures() const override;

 private:
  triangle_driver_params driver_;
  bih_builder_params builder_;
};

}  // namespace rtusim
