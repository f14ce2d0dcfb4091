#include "testbench/run/interrupts.h"

#include <signal.h>

namespace rtusim {
namespace {

volatile std::sig_atomic_t noted = 0;
extern "C" void note_signal(int) { noted = 1; }

}  // namespace

interrupts::interrupts() {
  noted = 0;
  struct sigaction to_note {};
  to_note.sa_handler = note_signal;
  for (std::size_t i = 0; i < signals.size(); ++i) {
    sigaction(signals[i], nullptr, &before_[i]);
    if (before_[i].sa_handler != SIG_IGN) sigaction(signals[i], &to_note, nullptr);
  }
}

interrupts::~interrupts() {
  for (std::size_t i = 0; i < signals.size(); ++i) sigaction(signals[i], &before_[i], nullptr);
}

bool interrupts::came() { return noted != 0; }

void interrupts::leave_to_parent() {
  for (const int number : signals) signal(number, SIG_IGN);
}

}  // namespace rtusim
