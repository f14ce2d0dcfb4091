#include <chrono>
#include <iostream>
#include "modules/config/error.h"
#include "modules/formats/svo_image.h"
#include "testbench/simulation.h"
#include "testbench/job_file.h"
int sc_main(int argc, char* argv[]) {
  using namespace rtusim;
  design d; 
  d.rtu.cores = static_cast<unsigned>(atoi(argv[1]));
  d.driver.last_sign_only = true;
  d.float_to_fixed = {true,true,true};
  auto& c = d.svo_core; c.far_popcount=c.negative_t=c.positive_normals=c.tm_wrap=c.stale_miss=true;
  d.result_manager_.valid_withdrawn = true;
  surroundings s;
  std::string r = argv[2];
  if (r == "gap1") s.source.valid = source_params::regime::gap;
  if (r == "pace4") s.source.valid = source_params::regime::paced;
  if (r == "bp") s.sink.ready = sink_params::regime::lfsr;
  if (r == "rnd") {s.sink.ready = sink_params::regime::lfsr; s.source.valid=source_params::regime::lfsr; }
  auto img = read_svo("testbench/golden/svo/models/dragon_32.svo");
  auto jobs = read_jobs(argv[3]);
  pace p = std::string(argv[4]) == "skipping" ? pace::skipping : std::string(argv[4]) == "stepped" ? pace::stepped : pace::checked;
  if (argc > 5) d.scheduler_.select = static_cast<scheduler::policy>(atoi(argv[5]));
  if (argc > 6) d.result_manager_.valid_withdrawn = false;
  std::optional<waveform_window> w;
  if (getenv("VCD")) w = waveform_window{getenv("VCD"), 0, never};
  try {
  simulation sim(d, s, img.words, jobs, p, w);
  std::string log = "cycle,core,job_id,hit,t_hit,normal_axis,cost,raw_t_hit,raw_normal_axis\n";
  if (!getenv("NOLOG")) sim.board().on_result([&](cycle cy, const traversal_result& q, const ray_waits&) {
    log += fmt::format("{},{},{},{},{},{},{},{},{}\n", cy, q.core, q.job_word, int(q.hit), q.hit ? q.t_hit : 0, q.hit ? q.normal_axis : -1, q.cost, q.t_hit, q.normal_axis);
  });
  auto t0 = std::chrono::steady_clock::now();
  sim.run();
  auto t1 = std::chrono::steady_clock::now();
  if (!getenv("NOLOG")) std::cout << log;
  double ns = std::chrono::duration<double, std::nano>(t1-t0).count();
  std::cerr << fmt::format("total {} last {} checksum {:016x} edges/ray {:.3f} unit edges/ray {:.2f} ns/ray {:.1f} ns/cycle {:.1f}\n", sim.total_cycles(), sim.board().last_accepted(), sim.board().checksum(), double(sim.clock().stats().edges)/double(jobs.size()), double(sim.clock().stats().unit_edges)/double(jobs.size()), ns/double(jobs.size()), ns/double(sim.total_cycles()));
  if (getenv("STATS")) { config::report rep; sim.describe_statistics(rep); std::cout << rep.values().dump(1); }
  } catch (std::exception& e) { std::cerr << e.what() << "\n"; return 1; }
  return 0;
}
