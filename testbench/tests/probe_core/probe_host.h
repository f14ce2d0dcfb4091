#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "testbench/kinds/host_kind.h"
#include "testbench/tests/probe_core/probe_core.h"

namespace rtusim::test {

/// The host's side of probe cores: no model, rays as voxel cores have them, a log of its own columns.
class probe_host final : public host_kind {
 public:
  std::string_view word() const override { return probe_kind::name; }
  void describe(config::schema&, const std::function<bool()>&) override {}
  bool needs_model() const override { return false; }
  std::unique_ptr<loaded_model> load(const design& d, const scene& what) const override;
  std::vector<lone_unit> units() const override;
};

}  // namespace rtusim::test
