#pragma once

#include <string>
#include <vector>

#include <muParser.h>
#include <nlohmann/json.hpp>

namespace rtusim {

/// Which runs of a sweep are wanted: an expression of their parameters, `rtu.cores <= 16 || is("scheduler.policy=round_robin")`.
class constraint {
 public:
  /// `place`: of the text, for errors.
  constraint(const std::string& text, const std::string& place);
  constraint(const constraint&) = delete;
  constraint& operator=(const constraint&) = delete;

  /// `parameters`: by section, as `schema::values` gives them.
  /// Errors: input_error for what is no expression, or one of parameters that are not read.
  bool allows(const nlohmann::ordered_json& parameters);

 private:
  double is(const std::string& text) const;

  std::string text_, place_;
  mu::Parser parser_;
  std::vector<double> numbers_;  // never beyond what was reserved: the parser keeps addresses
  const nlohmann::ordered_json* parameters_ = nullptr;
};

}  // namespace rtusim
