#include "modules/timing/waveform.h"

#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>
#include <utility>

#include "modules/config/error.h"
#include "modules/timing/channel.h"
#include "modules/timing/clock_domain.h"
#include "modules/timing/unit.h"

namespace rtusim {
namespace {

constexpr char axis_letters[] = "xyz";

template <class T>
void trace_axes(waveform& w, const std::string& name, const per_axis<T>& values, unsigned bits) {
  for (unsigned i = 0; i < 3; ++i) w.add(values[i], name + axis_letters[i], bits);
}

/// A word without a sign: as a signed one the tracer would show those of its upper half as unknown.
const std::uint64_t& without_sign(const std::int64_t& word) { return reinterpret_cast<const std::uint64_t&>(word); }

/// Blanks the date in SystemC's header, so that the same run gives the same bytes.
void blank_date(std::fstream& file) {
  std::string line;
  std::getline(file, line);
  const auto date = file.tellg();
  std::getline(file, line);
  file.seekp(date);
  file << std::string(line.size(), ' ');
}

/// Puts a time stamp before the initial values in place of the comment in which SystemC tells their time: viewers would take them
/// for those of time 0.
void stamp_initial_values(std::fstream& file) {
  constexpr std::string_view before = "All initial values";
  std::string line;
  file.seekg(0);
  auto begin = file.tellg();
  std::streamoff opening = 0;  // of the comment: the length of its first line
  while (std::getline(file, line) && line.compare(0, before.size(), before) != 0) {
    opening = static_cast<std::streamoff>(line.size()) + 1;
    begin = file.tellg() - opening;
  }
  const auto time = line.find("= ");
  if (time == std::string::npos) return;
  std::string stamp = "#" + line.substr(time + 2, line.find(' ', time + 2) - time - 2);
  std::getline(file, line);
  stamp.resize(static_cast<std::size_t>(file.tellg() - begin) - 1, ' ');
  file.seekp(begin);
  file << stamp;
}

/// Also sees that the last time stamp, which the tracer writes without looking, came to the disk.
void finish_file(const std::filesystem::path& written, const std::filesystem::path& name) {
  std::fstream file(written, std::ios::in | std::ios::out | std::ios::binary);
  blank_date(file);
  stamp_initial_values(file);
  file.clear();
  file.seekg(-24, std::ios::end);
  std::string tail{std::istreambuf_iterator<char>(file), {}};
  const auto stamp = tail.rfind("\n#");
  if (stamp == std::string::npos || tail.back() != '\n' || tail.find_first_not_of("0123456789", stamp + 2) != tail.size() - 1)
    throw input_error(name.string(), "the waveform could not be written to its end", "room for it on the disk");
}

}  // namespace

waveform::waveform(const sc_core::sc_module_name& name, std::filesystem::path file, const packet_widths& widths)
    : sc_module(name), path_(std::move(file)), widths_(widths), output_(path_), traced_(output_.temporary().string() + ".vcd") {
  if (output_.temporary() == path_) throw input_error(path_.string(), "a device or a pipe", "a file: a waveform is gone over at its end");
  output_.release();
  SC_HAS_PROCESS(waveform);
  SC_METHOD(fall);
  sensitive << half_period_;
  dont_initialize();
  sc_core::sc_report_handler::set_actions("tracing timescale unit set", sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
}

waveform::~waveform() {
  if (file_ != nullptr) sc_core::sc_close_vcd_trace_file(file_);
  std::error_code ignored;
  std::filesystem::remove(traced_, ignored);
}

void waveform::open(clock_domain& domain) {
  recorded_ = true;
  file_ = sc_core::sc_create_vcd_trace_file(output_.temporary().c_str());  // which adds the ending
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
  show(domain);
}

void waveform::show(clock_domain& domain) {
  clock_ = true;
  half_period_.notify(domain.period() / 2);
  cycle_ = domain.next_edge();
  for (channel_base* ch : domain.channels()) ch->show_levels(domain.next_edge());
}

void waveform::close() {
  if (file_ == nullptr) return;
  sc_core::sc_close_vcd_trace_file(std::exchange(file_, nullptr));
  std::error_code ignored;  // a file that is not there is found unfinished
  std::filesystem::rename(traced_, output_.temporary(), ignored);
  finish_file(output_.temporary(), path_);
  output_.commit();
}

void trace_fields(waveform& w, const std::string& name, const job_packet& p) {
  w.add(p.job_word, name + ".job_word");
  const bool triangles = w.widths().uv != 0;
  if (!triangles) w.add(p.address, name + ".address");
  trace_axes(w, name + (triangles ? ".origin_float_" : ".t0_float_"), p.t0, 32);
  trace_axes(w, name + (triangles ? ".direction_float_" : ".t1_float_"), p.t1, 32);
}

void trace_fields(waveform& w, const std::string& name, const traversal_job& j) {
  w.add(j.job_word, name + ".job_word");
  w.add(j.address, name + ".address");
  trace_axes(w, name + ".t0", j.t0, w.widths().t);
  trace_axes(w, name + ".t1", j.t1, w.widths().t);
}

void trace_fields(waveform& w, const std::string& name, const triangle_job& j) {
  w.add(j.job_word, name + ".job_word");
  w.add(j.ray.misses_box, name + ".misses_box");
  for (unsigned i = 0; i < 3; ++i) w.add(without_sign(j.ray.position[i]), name + ".pos_" + axis_letters[i], w.widths().position);
  trace_axes(w, name + ".dir_", j.ray.direction, w.widths().direction);
  trace_axes(w, name + ".idir_", j.ray.reciprocal, w.widths().reciprocal);
}

void trace_fields(waveform& w, const std::string& name, const traversal_result& r) {
  w.add(r.job_word, name + ".job_word");
  w.add(r.hit, name + ".hit");
  w.add(r.t_hit, name + ".t_hit", w.widths().t);
  w.add(r.cost, name + ".cost");
  if (w.widths().uv != 0) {
    w.add(r.triangle, name + ".triangle");
    w.add(without_sign(r.u), name + ".u", w.widths().uv);
    w.add(without_sign(r.v), name + ".v", w.widths().uv);
  } else {
    w.add(r.normal_axis, name + ".normal_axis", 3);
    w.add(r.normal_sign, name + ".normal_sign", 2);
  }
}

void trace_fields(waveform& w, const std::string& name, const std::uint32_t& word) { w.add(word, name + ".data"); }
void trace_fields(waveform& w, const std::string& name, const std::int64_t& word) { w.add(word, name + ".data"); }

}  // namespace rtusim
