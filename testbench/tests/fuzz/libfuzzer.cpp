// One target under libFuzzer, which calls this with inputs that it makes from those that led to something new.

#include <cstddef>
#include <cstdint>
#include <string>

#include "modules/config/error.h"
#include "testbench/tests/fuzz/target.h"
#include "testbench/tests/scratch.h"

// libsystemc wants one.
extern "C" int sc_main(int, char*[]) { return 1; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rtusim;
  static const test::scratch_folder folder;
  const fuzz::target& t = fuzz::targets().front();
  const auto file = fuzz::place(folder / "", t, {reinterpret_cast<const char*>(data), size});
  try {
    t.read(file);
  } catch (const input_error&) {}
  return 0;
}
