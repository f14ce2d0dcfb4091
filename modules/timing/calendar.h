#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "modules/timing/offer.h"

namespace rtusim {

/// Something that is due at a cycle: a channel's next transfer, a unit's next edge of its own.
struct booking {
  enum class what : std::uint8_t { channel, unit };

  explicit booking(what k) : kind(k) {}
  booking(const booking&) = delete;
  booking& operator=(const booking&) = delete;

  cycle at = never;
  const what kind;

 private:
  friend class calendar;
  booking* next_ = nullptr;
  booking** link_ = nullptr;  // the pointer that points here; null when not in a list
};

/// Bookings by cycle: a wheel of the next `slots` cycles with a bitmap over it, and a list for what lies beyond.
/// Booking, moving and taking back cost O(1).
class calendar {
 public:
  /// Moves a booking to a cycle not before the last one taken; `never` takes it back.
  void book(booking& b, cycle at) {
    if (b.at == at) return;
    if (b.link_ != nullptr) unlink(b);
    b.at = at;
    if (at == never) return;
    if (at - base_ < slots) {
      const auto slot = static_cast<std::size_t>(at % slots);
      link(b, wheel_[slot]);
      occupied_[slot / 64] |= std::uint64_t{1} << (slot % 64);
    } else {
      link(b, far_);
    }
  }

  /// The cycle of the earliest booking, or never.
  cycle earliest();

  /// Takes all bookings of cycle c (which must not be after the earliest) and calls `due` with each. Their `at` stays c: whoever takes
  /// them sets it to never before they may be booked again.
  template <class Due>
  void take(cycle c, Due&& due) {
    advance(c);
    const auto slot = static_cast<std::size_t>(c % slots);
    while (wheel_[slot] != nullptr) {
      booking& b = *wheel_[slot];
      unlink(b);
      due(b);
    }
    occupied_[slot / 64] &= ~(std::uint64_t{1} << (slot % 64));
  }

 private:
  static constexpr std::size_t slots = 1024;

  static void link(booking& b, booking*& head) {
    b.next_ = head;
    b.link_ = &head;
    if (head != nullptr) head->link_ = &b.next_;
    head = &b;
  }
  static void unlink(booking& b) {
    *b.link_ = b.next_;
    if (b.next_ != nullptr) b.next_->link_ = b.link_;
    b.link_ = nullptr;
    b.next_ = nullptr;
  }
  /// Lets the wheel begin at c and draws in what was beyond it.
  void advance(cycle c) {
    base_ = c;
    if (far_ != nullptr) draw_in();
  }
  void draw_in();

  cycle base_ = 0;
  std::array<booking*, slots> wheel_{};
  std::array<std::uint64_t, slots / 64> occupied_{};
  booking* far_ = nullptr;
};

}  // namespace rtusim
