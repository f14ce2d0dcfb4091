#pragma once

#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "modules/svo_core/svo_kind.h"
#include "testbench/kinds/driver.h"
#include "testbench/kinds/host_kind.h"

namespace rtusim {

/// The host's side of voxel cores.
class svo_host final : public host_kind {
 public:
  std::string_view word() const override { return svo_kind::name; }
  void describe(config::schema& s, const std::function<bool()>& is_chosen) override;
  std::unique_ptr<loaded_model> load(const design& d, const scene& what) const override;
  std::vector<lone_unit> units() const override;

 private:
  voxel_driver_params driver_;
};

}  // namespace rtusim
