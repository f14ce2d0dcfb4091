// The probe's lines in the two lists, for the program that the tests have beside the usual one.
#include "modules/rtu/core_kinds.h"
#include "testbench/tests/probe_core/probe_core.h"
#include "testbench/tests/probe_core/probe_host.h"

namespace rtusim::test {
namespace {

const bool is_registered = [] {
  add_core_kind([]() -> std::unique_ptr<core_kind> { return std::make_unique<probe_kind>(); });
  host_kinds::add([]() -> std::unique_ptr<host_kind> { return std::make_unique<probe_host>(); });
  return true;
}();

}  // namespace
}  // namespace rtusim::test
