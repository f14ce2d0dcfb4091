#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "modules/core_bank/core_kind.h"
#include "modules/job_manager/job_manager.h"
#include "modules/memory/memory.h"
#include "modules/numeric/fixed_point.h"
#include "modules/numeric/float_to_fixed.h"
#include "modules/svo_core/svo_core.h"
#include "modules/svo_core/svo_params.h"

namespace rtusim {

/// The words of octrees, one after the other, for the model memory.
class svo_contents final : public memory_contents {
 public:
  explicit svo_contents(const std::vector<std::uint32_t>& words) : words_(words) {}
  const std::vector<std::uint32_t>& words() const { return words_; }

 private:
  const std::vector<std::uint32_t>& words_;
};

/// `figures_of_bank`, and what the memory has counted.
std::vector<named_figures> svo_figures(const job_manager::stats& jobs, const scheduler_stats& dispatches,
                                       const std::vector<svo_core::stats>& cores, const result_manager_stats& results);

/// Voxel cores (Espe 2019): job_manager -> scheduler -> N x svo_core, all at one memory.
class svo_kind final : public core_kind {
 public:
  static constexpr std::string_view name = "svo";

  numeric::fixed_format format;
  numeric::float_to_fixed_errata conversion;
  svo_core_params core;
  memory::params memory_;

  svo_core_params core_with_format() const;
  job_manager::params jobs() const { return {format, conversion}; }

  std::string_view word() const override { return name; }
  std::unique_ptr<core_kind> copy() const override { return std::make_unique<svo_kind>(*this); }
  void describe_formats(config::schema& s, const readers& r) override;
  void describe_units(config::schema& s, const readers& r) override;
  void describe_memories(config::schema& s, const readers& r) override;
  packet_widths packets() const override { return {format.width()}; }
  unsigned fraction_bits() const override { return format.fraction_bits; }
  std::string replay_obstacle() const override { return memory_.which == memory::kind::lut ? "" : "a memory that makes cores wait"; }
  std::vector<named_figures> blank_figures() const override;
  std::unique_ptr<memory_contents> blank_contents() const override;
  std::unique_ptr<core_bank> build(const bank_params& p, const memory_contents& contents) const override;
};

}  // namespace rtusim
