#include "modules/timing/rotating_select.h"

namespace rtusim {

void rotating_select::select(unsigned line, cycle c) {
  phase_ = static_cast<unsigned>((line + lines() - c % lines()) % lines());
  remember(c, line);
}

std::uint64_t rotating_select::count(cycle from, cycle to) const {
  if (!any() || from >= to) return 0;
  const cycle length = to - from;
  const std::uint64_t turns = length < lines() ? 0 : length / lines();
  const auto rest = static_cast<unsigned>(length - turns * lines());
  const unsigned first = selected(from);
  const unsigned end = first + rest;
  const unsigned part = end <= lines() ? ones_within(first, end) : ones_within(first, lines()) + ones_within(0, end - lines());
  return turns * ones() + part;
}

}  // namespace rtusim
