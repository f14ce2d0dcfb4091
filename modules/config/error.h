#pragma once

#include <stdexcept>
#include <string>

#include <fmt/format.h>

namespace rtusim {

/// What a user gave us can't be used: a file, an option, a value. Caught once, in `sc_main`: one line, exit status 2.
///
/// The message reads `PLACE: FOUND; expected EXPECTED`, for instance
/// `designs/a.toml:7: scheduler.policy = "fifo"; expected cyclic_first_available, round_robin or first_available`.
class input_error : public std::runtime_error {
 public:
  input_error(const std::string& place, const std::string& found, const std::string& expected)
      : std::runtime_error(fmt::format("{}: {}; expected {}", place, found, expected)) {}
};

/// The simulation itself is at fault, or found a mismatch: exit status 1.
class simulation_error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

namespace detail {
template <class A, class B>
[[noreturn]] void check_failed(const char* file, int line, const char* text, const A& a, const B& b) {
  throw simulation_error(fmt::format("{}:{}: {} does not hold: {} against {}", file, line, text, a, b));
}
}  // namespace detail

}  // namespace rtusim

/// An invariant of the model, `RTU_CHECK(a, ==, b)`: also on in Release, prints both values.
#define RTU_CHECK(a, op, b)                                                                                                             \
  do {                                                                                                                                  \
    const auto& rtu_check_a = (a);                                                                                                      \
    const auto& rtu_check_b = (b);                                                                                                      \
    if (!(rtu_check_a op rtu_check_b)) ::rtusim::detail::check_failed(__FILE__, __LINE__, #a " " #op " " #b, rtu_check_a, rtu_check_b); \
  } while (false)
