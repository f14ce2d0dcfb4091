#pragma once

#include <charconv>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "modules/config/error.h"

namespace rtusim {

/// Adds a command with options of its own; when it is given, they are filled in and `action` is called with them.
template <class Options, class Action>
CLI::App& add_command(CLI::App& program, const std::string& name, const std::string& meaning, const std::shared_ptr<Options>& options,
                      Action action) {
  CLI::App& command = *program.add_subcommand(name, meaning);
  command.callback([options, action] { action(*options); });
  return command;
}

/// An option that takes a whole number, in digits alone: CLI11 would wrap -3 and cut what is too large.
template <class Number>
void add_number(CLI::App& app, const std::string& name, std::optional<Number>& to, const char* kind, const std::string& meaning) {
  const auto read = [name, &to](const std::string& text) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size())
      throw input_error(name, '"' + text + '"', fmt::format("a whole number from 0 to {}", std::numeric_limits<Number>::max()));
    to = value;
  };
  app.add_option_function<std::string>(name, read, meaning)->type_name(kind);
}

}  // namespace rtusim
