#include "testbench/run/summary.h"

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "modules/config/files.h"
#include "modules/config/printable.h"
#include "testbench/run/program_version.h"
#include "testbench/run/record_paths.h"

namespace rtusim {
namespace {

using json = nlohmann::ordered_json;

double share(const json& part, double whole) { return whole == 0 ? 0 : 100 * part.get<double>() / whole; }

double all_cycles(const json& cycles) {
  double sum = 0;
  for (const auto& c : cycles) sum += c.get<double>();
  return sum;
}

/// What the record tells of the model's size: `model_words` = 35 as words and 35.
std::pair<std::string, json> model_size(const json& inputs) {
  constexpr std::string_view start = "model_";
  for (const auto& [name, value] : inputs.items())
    if (name.rfind(start, 0) == 0 && value.is_number()) return {name.substr(start.size()), value};
  return {"words", 0};
}

std::string bar(double percent, unsigned width) {
  const auto filled = static_cast<std::size_t>(percent / 100 * width + 0.5);
  return std::string(filled, '#') + std::string(width - std::min<std::size_t>(filled, width), '.');
}

}  // namespace

void flatten(const json& from, const std::string& key, std::vector<std::pair<std::string, json>>& to) {
  if (!from.is_object()) {
    to.emplace_back(key, from);
    return;
  }
  for (const auto& [name, value] : from.items()) flatten(value, key.empty() ? name : key + '.' + name, to);
}

void simulator_figures::describe(config::report& r) const {
  const auto per_ray = [this](double figure) { return rays == 0 ? 0.0 : figure / static_cast<double>(rays); };
  r.number("version", program_version(), "", "of the program, with the commit of its sources; + where they differed from it");
  r.number("pace", pace, "", "how the run came by its cycles");
  r.number(
      "followed", followed, "",
      "what a replay went along: the select's turns, where nothing is fed back; each job; or each result's drain, too, where a sink lets "
      "results wait");
  r.number("run_seconds", run_seconds, "s", "wall time of the simulation alone");
  r.number("all_seconds", all_seconds, "s", "wall time with scene, jobs, pictures and logs");
  r.number("rays_per_second", static_cast<double>(rays) / run_seconds, "1/s", "rays simulated by wall time");
  r.number("cycles_per_second", static_cast<double>(cycles) / run_seconds, "1/s", "cycles simulated by wall time");
  r.number("ns_per_ray", per_ray(1e9 * run_seconds), "ns", "wall time by rays");
  r.number("edges", clock.edges, "edges", "clock edges at which units were called; a replay has none");
  r.number("unit_edges", clock.unit_edges, "calls", "calls of a unit at an edge");
  r.number("wake_ups", clock.wake_ups, "calls", "calls of the clock's SystemC process");
  r.number("edges_per_ray", per_ray(static_cast<double>(clock.edges)), "edges", "edges by rays");
}

std::string record_text(run_record record, const std::filesystem::path& folder) {
  name_files_from(folder, record.inputs, record.parameters);
  json all{{"format", "rtusim statistics"}, {"version", run_record::version}};
  all["inputs"] = std::move(record.inputs);
  all["parameters"] = std::move(record.parameters);
  all["statistics"] = std::move(record.statistics);
  all["simulator"] = std::move(record.simulator);
  return all.dump(2, ' ', false, json::error_handler_t::replace) + '\n';  // a file's name may be no UTF-8
}

void write_record(const std::filesystem::path& file, const run_record& record) {
  config::output_file out(file);
  out.write(record_text(record, folder_of_record(file)));
  out.commit();
}

std::string summary_text(const run_record& record) {
  const json& s = record.statistics;
  const json& rtu = record.parameters["rtu"];
  std::string t;
  const auto line = [&t](std::string_view format, const auto&... values) { t += fmt::format(fmt::runtime(format), values...) + '\n'; };

  const std::string kind = rtu["core"].get<std::string>();
  const json& cores_of_kind = s[kind + "_core"];
  const auto [word, size] = model_size(record.inputs);
  line("{} {} cores at {} MHz, {} on {} {}", rtu["cores"].get<unsigned>(), kind, rtu["clock_mhz"].get<double>(),
       config::printable(record.inputs["model"].get<std::string>()), size.get<std::uint64_t>(), word);
  if (record.inputs["architecture"].get<std::string>().empty())
    line("no --arch: the default design (testbench/architectures/espe2019.toml) with what --set changes");
  line("{:>14} cycles   {} rays, {} hits ({:.1f} %)", s["total_cycles"].get<std::uint64_t>(), s["rays"].get<std::uint64_t>(),
       s["hits"].get<std::uint64_t>(), share(s["hits"], s["rays"].get<double>()));
  line("{:>14.3f} cycles a ray", s["cycles_per_ray"].get<double>());
  line("{:>14.3f} M rays/s and {:.2f} frames/s at the clock ({:.3f} ms)", s["rays_per_second"].get<double>() / 1e6,
       s["frames_per_second"].get<double>(), s["seconds"].get<double>() * 1e3);
  line("");

  const json& latency = s["latency"];
  line("latency of a ray, cycles: mean {:.1f}, half within {}, 99 % within {}, most {}", latency["mean"].get<double>(),
       latency["p50"].get<std::uint64_t>(), latency["p99"].get<std::uint64_t>(), latency["most"].get<std::uint64_t>());
  for (const auto& [name, cycles] : s["waits"].items())
    line("{:>14} {:8.2f}  {}", name, cycles.get<double>(), bar(share(cycles, latency["mean"].get<double>()), 50));
  line("");

  line("cores, share of all cycles:  idle   walk    out   jobs");
  const auto core_line = [&](const std::string& name, const json& core) {
    const double all = all_cycles(core["cycles"]);
    const double idle = share(core["cycles"]["idle"], all);
    const double out = core["cycles"].contains("out") ? share(core["cycles"]["out"], all) : 0;
    line("{:>27} {:5.1f}% {:5.1f}% {:5.1f}% {:6}", name, idle, 100 - idle - out, out, core["jobs"].get<std::uint64_t>());
  };
  core_line("all", cores_of_kind);
  const auto cores = rtu["cores"].get<unsigned>();
  for (unsigned i = 0; i < cores; ++i)
    if (cores <= 16 || i < 4 || i + 4 >= cores) core_line("core_" + std::to_string(i), s["core_" + std::to_string(i)]);
  if (cores_of_kind.contains("fill"))
    line("{:>27} {:5.1f}% of the cores' walking cycles issue a triangle", "fill", 100 * cores_of_kind["fill"].get<double>());
  line("");

  line("channels, share of all cycles:  transferred  starved  back-pressured   idle");
  for (const char* name : {"job", "pending_job", "result"}) {
    const json& c = s["channels"][name];
    const double all = all_cycles(c);
    line("{:>30} {:11.1f}% {:7.1f}% {:14.1f}% {:5.1f}%", name, share(c["transferred"], all), share(c["starved"], all),
         share(c["back_pressured"], all), share(c["idle"], all));
  }
  line("");

  const json& m = record.simulator;
  line("simulated in {:.3f} s ({} with everything: {:.3f} s): {:.2f} M rays/s, {:.2f} M cycles/s, {:.2f} edges a ray",
       m["run_seconds"].get<double>(), m["pace"].get<std::string>(), m["all_seconds"].get<double>(),
       m["rays_per_second"].get<double>() / 1e6, m["cycles_per_second"].get<double>() / 1e6, m["edges_per_ray"].get<double>());
  return t;
}

}  // namespace rtusim
