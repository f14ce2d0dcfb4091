#pragma once

#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "modules/config/error.h"

namespace rtusim {

/// A policy as an argument: `typename decltype(p)::type`.
template <class Policy>
struct policy_type {
  using type = Policy;
};

/// Policies, each with an index: its place in the list, from 0.
template <class... Policies>
struct policy_list {
  static constexpr auto count = static_cast<unsigned>(sizeof...(Policies));

  /// One of them.
  using any = std::variant<Policies...>;

  template <class Policy>
  static constexpr unsigned index() {
    static_assert((std::is_same_v<Policy, Policies> || ...));
    unsigned i = 0;
    static_cast<void>(((std::is_same_v<Policy, Policies> || (++i, false)) || ...));
    return i;
  }
  static std::vector<std::string_view> names() { return {Policies::name...}; }
  static std::vector<std::string_view> meanings() { return {Policies::meaning...}; }

  /// What `f` returns, called with the `policy_type` of the policy with this index.
  template <class F>
  static auto with(unsigned i, F&& f) {
    return with_next<F, Policies...>(i, f);
  }

 private:
  template <class F, class First, class... Others>
  static auto with_next(unsigned i, F& f) {
    if constexpr (sizeof...(Others) == 0) {
      RTU_CHECK(i, ==, 0u);
      return f(policy_type<First>{});
    } else {
      return i == 0 ? f(policy_type<First>{}) : with_next<F, Others...>(i - 1, f);
    }
  }
};

}  // namespace rtusim
