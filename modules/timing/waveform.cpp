#include "modules/timing/waveform.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include "modules/timing/channel.h"
#include "modules/timing/clock_domain.h"
#include "modules/timing/unit.h"

namespace rtusim {
namespace {

/// The codes that VCD has for variables: the printable characters as digits.
std::string code_of(std::size_t number) {
  constexpr char first = '!', last = '~';
  constexpr std::size_t base = last - first + 1;
  std::string code;
  for (;; number = number / base - 1) {
    code += static_cast<char>(first + number % base);
    if (number < base) return code;
  }
}

std::uint64_t begin_of(const clock_domain& domain, cycle c) { return (domain.period() * static_cast<double>(c)).value(); }

}  // namespace

waveform::waveform(const std::filesystem::path& file, const packet_widths& widths) : widths_(widths), output_(file) {}

void waveform::open(clock_domain& domain) {
  recorded_ = true;
  add(clock_, "clock");
  add(cycle_, "cycle");
  for (const unit* u : domain.units()) u->trace(*this);
  for (const channel_base* ch : domain.channels()) {
    const std::string name = ch->name();
    add(ch->shown_valid_, name + ".valid");
    add(ch->shown_ready_, name + ".ready");
    add(ch->transfers_, name + ".transfers");
    ch->trace_payload(*this);
  }
  for (std::size_t i = 0; i < variables_.size(); ++i) variables_[i].code = code_of(i);
  declare();
  show(domain);
}

void waveform::declare() {
  std::vector<std::pair<std::string_view, const traced*>> in_modules;  // by the names of all modules around them
  for (const traced& v : variables_) in_modules.emplace_back(std::string_view(v.name).substr(0, v.name.rfind('.') + 1), &v);
  std::stable_sort(in_modules.begin(), in_modules.end(), [](const auto& a, const auto& b) { return a.first < b.first; });

  const auto out = std::back_inserter(text_);
  fmt::format_to(out, "$version\n     rtusim\n$end\n$timescale\n     1 ps\n$end\n$scope module SystemC $end\n");
  std::string_view open;  // the modules whose scopes are, each with a point after it
  for (const auto& [modules, v] : in_modules) {
    while (modules.substr(0, open.size()) != open) {
      open.remove_suffix(1);
      open = open.substr(0, open.rfind('.') + 1);
      fmt::format_to(out, "$upscope $end\n");
    }
    while (open.size() != modules.size()) {
      const std::size_t point = modules.find('.', open.size());
      fmt::format_to(out, "$scope module {} $end\n", modules.substr(open.size(), point - open.size()));
      open = modules.substr(0, point + 1);
    }
    const std::string range = v->bits == 1 ? "" : fmt::format(" [{}:0]", v->bits - 1);
    fmt::format_to(out, "$var wire {:>4} {:<3} {}{} $end\n", v->bits, v->code, v->name.substr(modules.size()), range);
  }
  for (const char c : open)
    if (c == '.') fmt::format_to(out, "$upscope $end\n");
  fmt::format_to(out, "$upscope $end\n$enddefinitions $end\n");
}

void waveform::write_time(std::uint64_t picoseconds) { fmt::format_to(std::back_inserter(text_), "#{}\n", picoseconds); }

void waveform::write_value(const traced& v) {
  if (v.bits == 1)
    fmt::format_to(std::back_inserter(text_), "{}{}\n", v.shown, v.code);
  else
    fmt::format_to(std::back_inserter(text_), "b{:b} {}\n", v.shown, v.code);
}

void waveform::write_fall() {
  traced& clock = variables_.front();
  write_time(fall_);
  clock.shown = 0;
  write_value(clock);
}

void waveform::show(clock_domain& domain) {
  const cycle coming = domain.next_edge();
  const bool is_first = end_ == 0;
  clock_ = true;
  cycle_ = coming;
  for (channel_base* ch : domain.channels()) ch->show_levels(coming);
  if (!is_first) write_fall();
  write_time(begin_of(domain, coming));
  if (is_first) text_.append(std::string_view("$dumpvars\n"));
  for (traced& v : variables_) {
    const std::uint64_t all = v.value(v.at), value = all & (~std::uint64_t{0} >> (64 - v.bits));
    if (!is_first && value == v.shown) continue;
    cut_values_ += all != value && static_cast<std::int64_t>(all) >> (v.bits - 1) != -1;
    v.shown = value;
    write_value(v);
  }
  if (is_first) text_.append(std::string_view("$end\n"));
  fall_ = begin_of(domain, coming) + (domain.period() / 2).value();
  end_ = begin_of(domain, coming + 1);
  output_->write({text_.data(), text_.size()});
  text_.clear();
}

void waveform::close() {
  if (!recorded_ || !output_) return;
  write_fall();
  write_time(end_);
  output_->write({text_.data(), text_.size()});
  output_->commit();
  output_.reset();
}

void trace_fields(waveform& w, const std::string& name, const std::uint32_t& word) { w.add(word, name + ".data"); }
void trace_fields(waveform& w, const std::string& name, const std::int64_t& word) { w.add(word, name + ".data"); }

}  // namespace rtusim
