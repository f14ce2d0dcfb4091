#include "modules/timing/waveform.h"

#include <fstream>
#include <iterator>
#include <utility>

#include "modules/config/error.h"
#include "modules/timing/channel.h"
#include "modules/timing/clock_domain.h"
#include "modules/timing/unit.h"

namespace rtusim {
namespace {

constexpr char axis_letters[] = "xyz";

template <class T>
void trace_axes(waveform& w, const std::string& name, const per_axis<T>& values) {
  for (unsigned i = 0; i < 3; ++i) w.add(values[i], name + axis_letters[i]);
}

/// Blanks the date in SystemC's header, so that the same run gives the same bytes, and sees that the last time stamp, which the
/// tracer writes without looking, came to the disk.
void finish_file(const std::filesystem::path& path) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  std::string line;
  std::getline(file, line);
  const auto date = file.tellg();
  std::getline(file, line);
  file.seekp(date);
  file << std::string(line.size(), ' ');
  file.seekg(-24, std::ios::end);
  std::string tail{std::istreambuf_iterator<char>(file), {}};
  const auto stamp = tail.rfind("\n#");
  if (stamp == std::string::npos || tail.back() != '\n' || tail.find_first_not_of("0123456789", stamp + 2) != tail.size() - 1)
    throw input_error(path.string(), "the waveform could not be written to its end", "room for it on the disk");
}

}  // namespace

waveform::waveform(const sc_core::sc_module_name& name, std::filesystem::path file) : sc_module(name), path_(std::move(file)) {
  SC_HAS_PROCESS(waveform);
  SC_METHOD(fall);
  sensitive << half_period_;
  dont_initialize();
}

waveform::~waveform() {
  if (file_ != nullptr) sc_core::sc_close_vcd_trace_file(file_);
}

void waveform::open(clock_domain& domain) {
  output_ = std::make_unique<config::output_file>(path_);
  output_->release();
  auto stem = output_->temporary();
  file_ = sc_core::sc_create_vcd_trace_file(stem.replace_extension().c_str());
  file_->set_time_unit(1, sc_core::SC_PS);
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
  refresh(domain);
}

void waveform::show(clock_domain& domain) {
  clock_ = true;
  half_period_.notify(domain.period() / 2);
  refresh(domain);
}

void waveform::refresh(clock_domain& domain) {
  cycle_ = domain.next_edge();
  for (channel_base* ch : domain.channels()) ch->show_levels(domain.next_edge());
}

void waveform::close() {
  if (file_ == nullptr) return;
  sc_core::sc_close_vcd_trace_file(std::exchange(file_, nullptr));
  finish_file(output_->temporary());
  output_->commit();
}

void trace_fields(waveform& w, const std::string& name, const job_packet& p) {
  w.add(p.job_word, name + ".job_word");
  w.add(p.address, name + ".address");
  trace_axes(w, name + ".t0_float_", p.t0);
  trace_axes(w, name + ".t1_float_", p.t1);
}

void trace_fields(waveform& w, const std::string& name, const traversal_job& j) {
  w.add(j.job_word, name + ".job_word");
  w.add(j.address, name + ".address");
  trace_axes(w, name + ".t0", j.t0);
  trace_axes(w, name + ".t1", j.t1);
}

void trace_fields(waveform& w, const std::string& name, const traversal_result& r) {
  w.add(r.job_word, name + ".job_word");
  w.add(r.hit, name + ".hit");
  w.add(r.t_hit, name + ".t_hit");
  w.add(r.normal_axis, name + ".normal_axis");
  w.add(r.normal_sign, name + ".normal_sign");
  w.add(r.cost, name + ".cost");
}

void trace_fields(waveform& w, const std::string& name, const std::uint32_t& word) { w.add(word, name + ".data"); }
void trace_fields(waveform& w, const std::string& name, const std::int64_t& word) { w.add(word, name + ".data"); }

}  // namespace rtusim
