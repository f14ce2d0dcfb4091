#include "modules/bih_core/bih_kind.h"

#include <string>
#include <vector>

#include "modules/bih_core/bih_core.h"
#include "modules/bih_core/bih_ray.h"
#include "modules/core_bank/figures_of_bank.h"
#include "modules/core_bank/typed_bank.h"
#include "modules/job_manager/triangle_job_manager.h"
#include "modules/triangle_unit/triangle_pipeline.h"

namespace rtusim {
namespace {

constexpr const char* when_chosen = "rtu.core = bih";

class bih_bank final : public typed_bank<triangle_job_manager, bih_core> {
 public:
  bih_bank(const bih_kind& kind, const bank_params& p, const bih_memory& hierarchy)
      : bih_bank(kind, p, hierarchy, std::make_shared<const bih_tables>(kind.words, hierarchy)) {}

 private:
  bih_bank(const bih_kind& kind, const bank_params& p, const bih_memory& hierarchy, const std::shared_ptr<const bih_tables>& tables)
      : typed_bank({kind.words, hierarchy.corner}, p, [&, params = kind.core_with_widths()](const char* n, std::size_t i) {
          return new bih_core(n, params, hierarchy, tables, static_cast<unsigned>(i));
        }) {
    const auto lists = lists_of(*tables, hierarchy, kind.words, kind.intersector.errata);
    for (unsigned i = 0; i < p.cores; ++i) {
      pipelines_.push_back(std::make_unique<triangle_pipeline>(("triangle_pipeline_" + std::to_string(i)).c_str(),
                                                               kind.intersector_with_words(), hierarchy.triangles, lists));
      core(i).intersector_port(*pipelines_.back());
    }
  }

  std::vector<std::unique_ptr<triangle_pipeline>> pipelines_;
};

/// One that holds its hierarchy.
class blank_hierarchy final : public bih_contents {
 public:
  explicit blank_hierarchy(unsigned address_bits) : bih_contents(words_), words_(address_bits) {}

 private:
  bih_memory words_;
};

}  // namespace

bih_core_params bih_kind::core_with_widths() const {
  bih_core_params p = core;
  p.widths = words;
  return p;
}

triangle_unit_params bih_kind::intersector_with_words() const {
  triangle_unit_params p = intersector;
  p.words = words;
  p.divider = divider.kind;
  return p;
}

void bih_kind::describe_formats(config::schema& s, const readers& r) {
  s.add("quantisation", words, r.home);
  s.read_when({"quantisation"}, r.is_chosen, when_chosen);
}

void bih_kind::describe_units(config::schema& s, const readers& r) {
  s.add("bih_core", core, r.home);
  s.add("t_div", divider, r.home);
  s.add("triangle_unit", intersector, r.home);
  s.read_when({"bih_core", "t_div", "triangle_unit"}, r.is_chosen, when_chosen);
  s.read_when(
      {"t_div.width"}, [&alone = r.alone] { return alone == "t_div"; }, "the unit t_div is alone");
}

packet_widths bih_kind::packets() const {
  return {words.n + 3, words.m, words.n, words.m, words.m + words.reciprocal_bits, "origin", "direction", false};
}

std::vector<named_figures> bih_kind::blank_figures() const {
  return figures_of_bank(triangle_job_manager::stats{}, {}, std::vector<bih_core::stats>(1), {});
}

std::unique_ptr<memory_contents> bih_kind::blank_contents() const { return std::make_unique<blank_hierarchy>(core.address_bits); }

std::unique_ptr<core_bank> bih_kind::build(const bank_params& p, const memory_contents& contents) const {
  return std::make_unique<bih_bank>(*this, p, dynamic_cast<const bih_contents&>(contents).hierarchy());
}

}  // namespace rtusim
