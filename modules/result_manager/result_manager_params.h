#pragma once

#include <cstdint>

#include "modules/config/report.h"
#include "modules/config/section.h"
#include "modules/config/wait_stats.h"

namespace rtusim {

struct result_manager_params {
  enum class order : std::uint8_t { as_finished };
  static config::word_list order_words() { return {"as_finished"}; }

  order leave = order::as_finished;
  bool valid_withdrawn = false;

  void describe(config::section& s);
};

struct result_manager_stats {
  wait_stats results;  ///< cycles from the one in which a buffer took each to the one in which it left

  void describe(config::report& r) const;
};

}  // namespace rtusim
