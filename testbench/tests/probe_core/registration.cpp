// The probe's lines in the two lists, for the program that the tests have beside the usual one.
#include "modules/rtu/core_kinds.h"
#include "testbench/tests/probe_core/probe_core.h"
#include "testbench/tests/probe_core/probe_host.h"

namespace rtusim::test {
namespace {

const bool is_registered = [] {
  core_kinds().add<probe_kind>();
  host_kinds::list().add<probe_host>();
  return true;
}();

}  // namespace
}  // namespace rtusim::test
