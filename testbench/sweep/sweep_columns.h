#pragma once

#include <string>
#include <vector>

namespace rtusim {

/// A column of a sweep's results: an axis or a figure.
struct column_meaning {
  std::string name;
  std::string unit;
  std::string meaning;
};

/// Units and meanings of columns, in their order; empty for a name that is none.
std::vector<column_meaning> meanings_of(const std::vector<std::string>& columns);

/// All parameters that an axis can turn.
std::vector<column_meaning> all_axes();

/// The figures that a sweep keeps which names none.
const std::vector<std::string>& usual_record();

/// Whether there is a figure, or a group of them, of that name; if not, `names` has all that there are.
bool is_figure(const std::string& name, std::vector<std::string>& names);

}  // namespace rtusim
