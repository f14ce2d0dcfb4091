#include "modules/svo_core/svo_kind.h"

#include "modules/core_bank/figures_of_bank.h"
#include "modules/core_bank/typed_bank.h"
#include "modules/svo_core/svo_ahead.h"

namespace rtusim {
namespace {

constexpr const char* when_chosen = "rtu.core = svo";

/// The cores and the memory that they share.
class svo_bank final : public typed_bank<job_manager, svo_core> {
 public:
  svo_bank(const svo_kind& kind, const bank_params& p, const svo_contents& contents)
      : typed_bank(
            kind.jobs(), p,
            [params = kind.core_with_format()](const char* n, std::size_t i) { return new svo_core(n, params, static_cast<unsigned>(i)); }),
        params_(kind.core_with_format()),
        conversion_(kind.conversion),
        memory_("memory", kind.memory_, contents.words()) {
    for (unsigned i = 0; i < p.cores; ++i) core(i).memory_port(memory_);
  }

  void expect(const std::vector<job_packet>& jobs) override {
    ahead_ = std::make_unique<svo_ahead>(params_, conversion_, memory_.words(), jobs);
    manager().leave_conversion_to([this](std::uint64_t count) { return ahead_->conversions(count); });
    for (unsigned i = 0; i < cores(); ++i) core(i).follow(*ahead_);
  }

 private:
  svo_core_params params_;
  numeric::float_to_fixed_errata conversion_;
  memory memory_;
  std::unique_ptr<svo_ahead> ahead_;
};

}  // namespace

svo_core_params svo_kind::core_with_format() const {
  svo_core_params p = core;
  p.format = format;
  return p;
}

void svo_kind::describe_formats(config::schema& s, const readers& r) {
  s.add("fixed_point", format, r.home);
  s.add("float_to_fixed", conversion, r.home);
  s.read_when({"fixed_point", "float_to_fixed"}, r.is_chosen, when_chosen);
}

void svo_kind::describe_units(config::schema& s, const readers& r) {
  s.add("svo_core", core, r.home);
  s.read_when({"svo_core"}, r.is_chosen, when_chosen);
}

void svo_kind::describe_memories(config::schema& s, const readers& r) {
  s.add("memory", memory_, r.home);
  s.read_when({"memory"}, r.is_chosen, when_chosen);
}

std::vector<named_figures> svo_figures(const job_manager::stats& jobs, const scheduler_stats& dispatches,
                                       const std::vector<svo_core::stats>& cores, const result_manager_stats& results) {
  memory::stats reads;
  for (const auto& core : cores) reads.fetches += core.fetches();
  std::vector<named_figures> all = figures_of_bank(jobs, dispatches, cores, results);
  all.push_back({"memory", as_figures(reads)});
  return all;
}

std::vector<named_figures> svo_kind::blank_figures() const { return svo_figures({}, {}, {{}}, {}); }

std::unique_ptr<memory_contents> svo_kind::blank_contents() const {
  static const std::vector<std::uint32_t> no_words;
  return std::make_unique<svo_contents>(no_words);
}

std::unique_ptr<core_bank> svo_kind::build(const bank_params& p, const memory_contents& contents) const {
  return std::make_unique<svo_bank>(*this, p, dynamic_cast<const svo_contents&>(contents));
}

}  // namespace rtusim
