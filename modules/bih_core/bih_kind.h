#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "modules/bih_core/bih_params.h"
#include "modules/core_bank/core_kind.h"
#include "modules/formats/bih_memory.h"
#include "modules/formats/quantisation.h"
#include "modules/t_div/t_div.h"
#include "modules/triangle_unit/triangle_unit.h"

namespace rtusim {

/// A hierarchy over triangles, in the memories that each core has.
class bih_contents : public memory_contents {
 public:
  explicit bih_contents(const bih_memory& hierarchy) : hierarchy_(hierarchy) {}
  const bih_memory& hierarchy() const { return hierarchy_; }

 private:
  const bih_memory& hierarchy_;
};

/// Triangle cores (Hanika 2007): triangle_job_manager -> scheduler -> N x bih_core, each with a triangle_pipeline of its own.
class bih_kind final : public core_kind {
 public:
  static constexpr std::string_view name = "bih";

  quantisation words;
  bih_core_params core;
  t_div::params divider;
  triangle_unit_params intersector;

  bih_core_params core_with_widths() const;
  triangle_unit_params intersector_with_words() const;

  std::string_view word() const override { return name; }
  std::unique_ptr<core_kind> copy() const override { return std::make_unique<bih_kind>(*this); }
  void describe_formats(config::schema& s, const readers& r) override;
  void describe_units(config::schema& s, const readers& r) override;
  packet_widths packets() const override;
  unsigned fraction_bits() const override { return 0; }
  std::string replay_obstacle() const override {
    return divider.kind == numeric::divider_kind::pipelined ? "" : "an iterative divider, which lets a ray wait for the one before";
  }
  std::vector<named_figures> blank_figures() const override;
  std::unique_ptr<memory_contents> blank_contents() const override;
  std::unique_ptr<core_bank> build(const bank_params& p, const memory_contents& contents) const override;
};

}  // namespace rtusim
