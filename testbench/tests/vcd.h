#pragma once

#include <catch2/catch.hpp>

#include <cstdint>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "modules/config/files.h"

namespace rtusim::test {

/// A VCD file by cycle, of a clock of 100 MHz. Values change as a cycle begins; the clock falls in its middle.
class vcd {
 public:
  explicit vcd(const std::filesystem::path& file) {
    std::istringstream in(config::read_file(file));
    read_declarations(in);
    read_values(in);
  }

  std::uint64_t first() const { return first_; }
  std::uint64_t cycles() const { return values_.size(); }
  std::uint64_t end() const { return first_ + cycles(); }
  const std::map<std::string, std::size_t>& signals() const { return signals_; }
  /// The values of a cycle in the order of the signals' declaration.
  const std::vector<std::uint64_t>& at(std::uint64_t cycle) const { return values_.at(cycle - first_); }
  std::uint64_t value(std::uint64_t cycle, const std::string& name) const { return at(cycle).at(signals_.at(name)); }
  std::int64_t signed_value(std::uint64_t cycle, const std::string& name) const {
    const unsigned up = 64 - width(name);
    return static_cast<std::int64_t>(value(cycle, name) << up) >> up;
  }
  unsigned width(const std::string& name) const { return widths_.at(signals_.at(name)); }
  bool transfers(std::uint64_t cycle, const std::string& channel) const {
    return value(cycle, channel + ".valid") != 0 && value(cycle, channel + ".ready") != 0;
  }
  /// The cycles in which a channel transfers.
  std::vector<std::uint64_t> transfers(const std::string& channel) const {
    std::vector<std::uint64_t> found;
    for (std::uint64_t c = first(); c < end(); ++c)
      if (transfers(c, channel)) found.push_back(c);
    return found;
  }

 private:
  static constexpr std::uint64_t period_ps = 10'000;

  void read_declarations(std::istream& in) {
    std::vector<std::string> scopes;
    std::string word, kind, code, name;
    while (in >> word && word != "$enddefinitions") {
      if (word == "$timescale") {
        std::string number, unit;
        in >> number >> unit;
        REQUIRE(number + unit == "1ps");
      } else if (word == "$scope") {
        in >> kind >> name;
        scopes.push_back(name);
      } else if (word == "$upscope") {
        scopes.pop_back();
      } else if (word == "$var") {
        unsigned width = 0;
        in >> kind >> width >> code >> name;
        std::string path;
        for (std::size_t i = 1; i < scopes.size(); ++i) path += scopes[i] + '.';  // the first is SystemC itself
        REQUIRE(signals_.emplace(path + name, widths_.size()).second);
        codes_.emplace(code, widths_.size());
        widths_.push_back(width);
      }
    }
    REQUIRE(scopes.empty());
  }

  void read_values(std::istream& in) {
    std::vector<std::uint64_t> now(widths_.size());
    const std::size_t clock = signals_.at("clock");
    std::uint64_t time = 0;
    bool started = false;
    std::string line;
    const auto require = [&line, &time](bool holds, const char* what) {
      if (!holds) FAIL(what << ": " << line << " at " << time);
    };
    while (std::getline(in, line)) {
      if (line.empty() || line[0] == '$' || line[0] == ' ') continue;
      if (line[0] == '#') {
        const std::uint64_t stamp = std::stoull(line.substr(1));
        require(stamp % (period_ps / 2) == 0, "time within a half period");
        if (!started) first_ = stamp / period_ps;
        started = true;
        for (; time / period_ps < stamp / period_ps; time = (time / period_ps + 1) * period_ps)
          if (time / period_ps >= first_) values_.push_back(now);
        time = stamp;
        continue;
      }
      const bool scalar = line[0] != 'b';
      const auto space = line.find(' ');
      const std::string_view bits = std::string_view(line).substr(scalar ? 0 : 1, scalar ? 1 : space - 1);
      const std::size_t signal = codes_.at(line.substr(scalar ? 1 : space + 1));
      require(started, "value without a time");
      require(bits.find_first_not_of("01") == std::string_view::npos, "unknown bits");
      require(bits.size() <= widths_[signal], "wider than declared");
      std::uint64_t value = 0;
      for (const char bit : bits) value = value << 1 | (bit == '1');
      require((signal == clock ? value : 1) == (time % period_ps == 0), "not at the clock's edge");
      now[signal] = signal == clock ? 1 : value;
    }
    REQUIRE(time % period_ps == 0);
  }

  std::map<std::string, std::size_t> signals_;
  std::map<std::string, std::size_t> codes_;
  std::vector<unsigned> widths_;
  std::uint64_t first_ = 0;
  std::vector<std::vector<std::uint64_t>> values_;
};

/// Every signal of the window has the value that it has in the recording of the whole run, from the first to the last.
inline void check_within(const vcd& window, const vcd& whole) {
  REQUIRE(window.signals() == whole.signals());
  REQUIRE(window.end() <= whole.end());
  for (std::uint64_t c = window.first(); c < window.end(); ++c) {
    if (window.at(c) == whole.at(c)) continue;
    for (const auto& [name, signal] : window.signals()) {
      CAPTURE(c, name);
      REQUIRE(window.at(c)[signal] == whole.at(c)[signal]);
    }
  }
}

}  // namespace rtusim::test
