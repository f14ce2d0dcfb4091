#include "testbench/sweep/constraint.h"

#include <cmath>

#include <fmt/format.h>

#include "modules/config/error.h"

namespace rtusim {

constraint::constraint(const std::string& text, const std::string& place) : text_(text), place_(place) {
  parser_.DefineNameChars("0123456789_.abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ");
  parser_.DefineFunUserData(
      "is", [](void* self, const mu::char_type* pair) -> mu::value_type { return static_cast<constraint*>(self)->is(pair); }, this);
}

bool constraint::allows(const nlohmann::ordered_json& parameters) {
  parameters_ = &parameters;
  numbers_.clear();
  parser_.ClearVar();
  numbers_.reserve(256);
  for (const auto& [section, fields] : parameters.items())
    for (const auto& [field, v] : fields.items()) {
      if (!v.is_number() && !v.is_boolean()) continue;
      numbers_.push_back(v.is_boolean() ? static_cast<double>(v.get<bool>()) : v.get<double>());
      parser_.DefineVar(section + '.' + field, &numbers_.back());
    }
  try {
    parser_.SetExpr(text_);
    const double result = parser_.Eval();
    if (std::isnan(result)) throw input_error(place_, "\"" + text_ + "\", which is no number here", "an expression that is 0 or not");
    return result != 0;
  } catch (const mu::Parser::exception_type& e) {
    throw input_error(place_, fmt::format("\"{}\": {}", text_, e.GetMsg()),
                      "an expression of parameters that are read, such as rtu.cores <= 16, or is(\"KEY=WORD\")");
  }
}

/// KEY=WORD
double constraint::is(const std::string& text) const {
  const auto equals = text.find('=');
  const std::string key = text.substr(0, equals), word = equals == std::string::npos ? "" : text.substr(equals + 1);
  const auto dot = key.find('.');
  const auto section = parameters_->find(key.substr(0, dot));
  if (dot == std::string::npos || section == parameters_->end() || !section->contains(key.substr(dot + 1)))
    throw input_error(place_, "is(\"" + text + "\")", "is(\"KEY=WORD\") with a parameter that is read");
  const auto& v = section->at(key.substr(dot + 1));
  return (v.is_string() ? v.get<std::string>() : v.dump()) == word ? 1 : 0;
}

}  // namespace rtusim
