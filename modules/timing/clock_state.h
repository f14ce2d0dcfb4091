#pragma once

#include <cstddef>
#include <vector>

#include "modules/timing/offer.h"

namespace rtusim {

class channel_base;

/// A list that holds each of a known number of things once at most, so that adding to it is a store.
template <class T>
class work_list {
 public:
  void reserve(std::size_t most) { items_.resize(most); }
  void push(T* item) { items_[size_++] = item; }
  void clear() { size_ = 0; }
  std::size_t size() const { return size_; }
  T*& operator[](std::size_t i) { return items_[i]; }

 private:
  std::vector<T*> items_;
  std::size_t size_ = 0;
};

/// What units and channels see of their clock at every turn.
struct clock_state {
  cycle now = never;                           ///< the edge being done
  cycle next = 0;                              ///< the edge to be done next: all before it are done
  std::vector<work_list<channel_base>> dirty;  ///< channels whose offers changed, by rank
};

}  // namespace rtusim
