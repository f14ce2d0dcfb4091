#include "testbench/kinds/loaded_model.h"

#include <utility>

#include "modules/config/error.h"

namespace rtusim {

sent_jobs loaded_model::jobs(std::vector<job_packet> given) const {
  sent_jobs sent{std::move(given), host()};
  sent.host.duplicate_ids = duplicate_ids(sent.packets);
  return sent;
}

sent_jobs loaded_model::jobs(const design& d, const scene& what, unsigned threads, bool pictured) const {
  const raster& f = what.picture;
  sent_jobs sent{{}, host()};
  std::size_t rays = std::size_t{f.width} * f.height;
  if (!what.model.rays.empty()) {
    const ray_list list(what.model.rays);
    if (pictured && list.size() != rays)
      throw input_error(what.model.rays, fmt::format("{} rays for a frame of {} x {}", list.size(), f.width, f.height),
                        "frame.width times frame.height of them, or no --image");
    rays = list.size();
    sent.packets = list_jobs(d, list, threads, sent.host);
  } else {
    sent.packets = camera_jobs(d, what, threads, sent.host);
  }
  sent.host.unsent_rays = rays - sent.packets.size();
  return sent;
}

}  // namespace rtusim
