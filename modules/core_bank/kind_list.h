#pragma once

#include <memory>
#include <vector>

namespace rtusim {

/// A list of kinds, in the order of their words, of which whoever needs them makes an object each. A program may add its own before it
/// makes any.
template <class Base>
class kind_list {
 public:
  template <class... Kinds>
  static kind_list of() {
    kind_list all;
    (all.template add<Kinds>(), ...);
    return all;
  }
  template <class Kind>
  void add() {
    makers_.push_back([]() -> std::unique_ptr<Base> { return std::make_unique<Kind>(); });
  }
  std::vector<std::unique_ptr<Base>> make() const {
    std::vector<std::unique_ptr<Base>> kinds;
    for (const auto maker : makers_) kinds.push_back(maker());
    return kinds;
  }

 private:
  std::vector<std::unique_ptr<Base> (*)()> makers_;
};

}  // namespace rtusim
