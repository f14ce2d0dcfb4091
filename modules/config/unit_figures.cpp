#include "modules/config/unit_figures.h"

#include <set>

namespace rtusim {

void describe(const std::vector<named_figures>& units, config::report& r) {
  std::set<std::string_view> summed;
  for (const auto& unit : units) {
    const std::string_view name = unit.figures->sum_name();
    if (!name.empty() && summed.insert(name).second) {
      std::unique_ptr<unit_figures> sum;
      for (const auto& other : units)
        if (other.figures->sum_name() == name) other.figures->add_to(sum);
      r.group(name, [&](config::report& g) { sum->describe(g); });
    }
    r.group(unit.name, [&](config::report& g) { unit.figures->describe(g); });
  }
}

}  // namespace rtusim
