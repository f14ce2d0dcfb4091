#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "modules/bih_core/bih_params.h"
#include "modules/config/schema.h"
#include "modules/formats/quantisation.h"
#include "modules/job_manager/job_manager.h"
#include "modules/memory/memory.h"
#include "modules/numeric/fixed_point.h"
#include "modules/numeric/float_to_fixed.h"
#include "modules/result_manager/result_manager.h"
#include "modules/scheduler/scheduler.h"
#include "modules/svo_core/svo_params.h"
#include "modules/t_div/t_div.h"
#include "modules/timing/waveform.h"
#include "modules/triangle_unit/triangle_unit.h"

namespace rtusim {

/// Which units an RTU consists of.
struct rtu_params {
  enum class core_kind : std::uint8_t { svo, bih };
  static config::word_list core_words() { return {"svo", "bih"}; }

  core_kind core = core_kind::svo;
  unsigned cores = 16;
  double clock_mhz = 100;

  void describe(config::section& s);
};

/// What a direction's length is measured by: the sum of its components' magnitudes, or their root of squares.
enum class direction_norm : std::uint8_t { one, two };

/// What the host's driver does as it sends rays (Espe 2019, app. F; Hanika 2007, sec. 2.1).
struct driver_params {
  static config::word_list norm_words() { return {"one", "two"}; }

  bool last_sign_only = false;
  bool only_zero_replaced = false;
  direction_norm norm = direction_norm::two;
  bool skip_misses = true;

  void describe(config::section& s);
};

/// How the host builds hierarchies for triangle cores.
struct bih_builder_params {
  unsigned leaf_triangles = 8;

  void describe(config::section& s);
};

/// A design: the parameters of every unit, as an architecture file gives them. The defaults are the RTU of Espe 2019 with its errata
/// put right.
struct design {
  rtu_params rtu;
  driver_params driver;
  numeric::fixed_format fixed_point;
  numeric::float_to_fixed_errata float_to_fixed;
  quantisation quantisation_;
  bih_builder_params bih_builder;
  scheduler_params scheduler_;
  svo_core_params svo_core;
  bih_core_params bih_core;
  t_div::params t_div_;
  triangle_unit_params triangle_unit_;
  result_manager::params result_manager_;
  memory::params memory_;
  /// The unit that is alone, of which only the parameters are read; empty: a whole RTU.
  std::string benched;

  /// Adds all sections; the design must then stay where it is.
  void describe(config::schema& s);
  /// The kind of file that these sections stand in.
  static constexpr std::string_view home = "an architecture file";
  /// Whether its cores, or the unit that is alone, work on triangles.
  bool has_triangles() const;

  job_manager::params job_manager_params() const { return {fixed_point, float_to_fixed}; }
  svo_core_params svo_core_params_with_format() const;
  triangle_unit_params triangle_unit_params_with_words() const;
  bih_core_params bih_core_params_with_widths() const;
  packet_widths packets() const;
};

}  // namespace rtusim
