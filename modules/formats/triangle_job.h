#pragma once

#include <cstdint>
#include <string>

#include "modules/formats/packets.h"
#include "modules/formats/quantisation.h"

namespace rtusim {

/// A ray as the triangle cores see it.
struct triangle_job : core_job {
  quantised_ray ray;  ///< from where it enters the box, or from its origin within
};

template <class Trace>
void trace_fields(Trace& to, const std::string& name, const triangle_job& j) {
  to.add(j.job_word, name + ".job_word");
  to.add(j.ray.misses_box, name + ".misses_box");
  trace_axes(to, name + ".pos_", j.ray.position, to.widths().position);
  trace_axes(to, name + ".dir_", j.ray.direction, to.widths().direction);
  trace_axes(to, name + ".idir_", j.ray.reciprocal, to.widths().reciprocal);
}

}  // namespace rtusim
