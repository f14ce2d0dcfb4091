#include "modules/svo_core/svo_kind.h"

#include <utility>

namespace rtusim {
namespace {

constexpr const char* when_chosen = "rtu.core = svo";

/// The cores and the memory that they share.
class svo_bank final : public typed_bank<traversal_job, job_manager, svo_core> {
 public:
  svo_bank(const svo_kind& kind, const bank_params& p, const svo_contents& contents)
      : svo_bank(kind, p, std::make_unique<memory>("memory", kind.memory_, contents.words())) {}

  unsigned job_latency_cycles() const override { return job_manager::latency_cycles; }
  unsigned core_latency_cycles() const override { return 1; }

 private:
  svo_bank(const svo_kind& kind, const bank_params& p, std::unique_ptr<memory> words)
      : typed_bank(
            kind.word(), kind.jobs(), p,
            [params = kind.core_with_format()](const char* n, std::size_t i) { return new svo_core(n, params, static_cast<unsigned>(i)); }),
        memory_(std::move(words)) {
    for (auto& core : cores()) core.memory_port(*memory_);
  }

  std::unique_ptr<memory> memory_;
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

std::unique_ptr<bank_figures> svo_kind::no_figures() const {
  auto figures = std::make_unique<svo_figures>(name);
  figures->cores.resize(1);
  return figures;
}

std::unique_ptr<core_bank> svo_kind::build(const bank_params& p, const memory_contents& contents) const {
  return std::make_unique<svo_bank>(*this, p, dynamic_cast<const svo_contents&>(contents));
}

}  // namespace rtusim
