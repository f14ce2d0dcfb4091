#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "modules/config/error.h"
#include "modules/config/schema.h"
#include "modules/core_bank/core_kind.h"
#include "modules/result_manager/result_manager_params.h"
#include "modules/scheduler/scheduler_params.h"

namespace rtusim {

/// Which units an RTU consists of.
struct rtu_params {
  unsigned core = 0;  ///< index of the kind, see `core_words`
  unsigned cores = 16;
  double clock_mhz = 100;

  void describe(config::section& s);
};

/// A design: the parameters of every unit, as an architecture file gives them. The defaults are the RTU of Espe 2019 with its errata
/// put right.
class design {
 public:
  rtu_params rtu;
  scheduler_params scheduler_;
  result_manager_params result_manager_;
  /// The unit that is alone, of which only the parameters are read; empty: a whole RTU.
  std::string benched;

  design();
  design(const design& other);
  design& operator=(const design& other);

  /// Adds all sections; the design must then stay where it is.
  void describe(config::schema& s);
  /// The kind of file that these sections stand in.
  static constexpr std::string_view home = "an architecture file";

  /// The kind of its cores.
  const core_kind& kind() const { return *kinds_[rtu.core]; }
  /// The parameters that it has of a kind, whether its cores are of it or not.
  template <class Kind>
  Kind& of() {
    for (const auto& k : kinds_)
      if (auto* found = dynamic_cast<Kind*>(k.get())) return *found;
    throw simulation_error("a kind of core that is not in the list");
  }
  template <class Kind>
  const Kind& of() const {
    return const_cast<design*>(this)->of<Kind>();
  }
  /// Makes its cores of a kind.
  template <class Kind>
  Kind& choose() {
    for (rtu.core = 0; rtu.core < kinds_.size(); ++rtu.core)
      if (auto* found = dynamic_cast<Kind*>(kinds_[rtu.core].get())) return *found;
    throw simulation_error("a kind of core that is not in the list");
  }

  /// The same by its word. Errors: simulation_error for a word of no kind.
  void choose(std::string_view word);

 private:
  std::vector<std::unique_ptr<core_kind>> kinds_;  // all that there are
};

}  // namespace rtusim
