#pragma once

#include "modules/config/error.h"
#include "modules/timing/channel.h"

namespace rtusim {

/// A channel whose ends are known by type: it calls both without virtual calls. Ports bind to it as to any channel.
template <class T, class From, class To>
class link final : public channel<T> {
 public:
  explicit link(const char* name) : channel<T>(name) {}

 private:
  void bind_ends(unit& producer, unit& consumer) override {
    from_ = dynamic_cast<From*>(&producer);
    to_ = dynamic_cast<To*>(&consumer);
    if (from_ == nullptr || to_ == nullptr) throw simulation_error(fmt::format("link {} has an end of another type", this->name()));
  }
  void hand_over() override {
    to_->To::arrives(*this);
    from_->From::leaves(*this);
  }

  From* from_ = nullptr;
  To* to_ = nullptr;
};

}  // namespace rtusim
