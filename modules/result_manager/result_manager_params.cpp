#include "modules/result_manager/result_manager_params.h"

namespace rtusim {

void result_manager_stats::describe(config::report& r) const {
  r.number("results", results.count, "results", "results sent out");
  results.describe(r, "cycles from the one in which a buffer takes a result to the one in which it leaves",
                   "the same of the result that waits longest");
}

void result_manager_params::describe(config::section& s) {
  s.choice("order", leave, order_words(), "as_finished: results leave in the order in which the select finds them");
  s.erratum("valid_withdrawn", valid_withdrawn, "the select turns even while a result is offered and not taken",
            "the offer stays until taken");
}

}  // namespace rtusim
