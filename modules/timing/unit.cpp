#include "modules/timing/unit.h"

#include "modules/timing/clock_domain.h"

namespace rtusim {

unit::unit(const sc_core::sc_module_name& name) : sc_module(name), booking(what::unit) { clock_domain::current().add(*this); }

}  // namespace rtusim
