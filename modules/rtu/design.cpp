#include "modules/rtu/design.h"

#include "modules/rtu/core_kinds.h"

namespace rtusim {

void rtu_params::describe(config::section& s) {
  s.choice("core", core, core_words(), "kind of the traversal cores");
  s.number("cores", cores, {1, 1024}, "cores", "traversal cores");
  s.real("clock_mhz", clock_mhz, {0.001, 1e6}, "MHz", "clock of all units");
}

design::design() : kinds_(core_kinds().make()) {}

design::design(const design& other) { *this = other; }

design& design::operator=(const design& other) {
  if (this == &other) return *this;
  rtu = other.rtu;
  scheduler_ = other.scheduler_;
  result_manager_ = other.result_manager_;
  benched = other.benched;
  kinds_.clear();
  for (const auto& k : other.kinds_) kinds_.push_back(k->copy());
  return *this;
}

void design::choose(std::string_view word) {
  for (rtu.core = 0; rtu.core < kinds_.size(); ++rtu.core)
    if (kinds_[rtu.core]->word() == word) return;
  throw simulation_error("cores of kind " + std::string(word) + ", which is not in the list");
}

void design::describe(config::schema& s) {
  const auto all_kinds = [&](void (core_kind::*add)(config::schema&, const core_kind::readers&)) {
    for (std::size_t i = 0; i < kinds_.size(); ++i) ((*kinds_[i]).*add)(s, {home, [this, i] { return rtu.core == i; }, benched});
  };
  s.add("rtu", rtu, home);
  s.entry_form("rtu.core", {{"kind", "rtu.core"}, {"count", "rtu.cores"}});
  all_kinds(&core_kind::describe_formats);
  s.add("scheduler", scheduler_, home);
  all_kinds(&core_kind::describe_units);
  s.add("result_manager", result_manager_, home);
  all_kinds(&core_kind::describe_memories);
}

}  // namespace rtusim
