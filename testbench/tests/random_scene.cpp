#include "testbench/tests/random_scene.h"

#include "testbench/kinds/driver.h"

namespace rtusim::test {
namespace {

double uniform(rng& random, double least, double most) { return std::uniform_real_distribution<double>(least, most)(random); }

job_packet random_ray(rng& random, std::uint32_t id) {
  per_axis<double> origin, direction;
  for (unsigned i = 0; i < 3; ++i) {
    origin[i] = uniform(random, -3, 3);
    direction[i] = random() % 16 == 0 ? 0 : uniform(random, -0.9, 0.9) - (random() % 4 != 0 ? origin[i] : 0);
  }
  return traversal_parameters(origin, direction, id, {random() % 2 == 0}, 0);
}

}  // namespace

svo_core_params as_built() {
  svo_core_params p;
  p.far_popcount = p.negative_t = p.positive_normals = p.tm_wrap = p.stale_miss = true;
  return p;
}

svo_core_params random_core(rng& random) {
  svo_core_params p;
  const auto coin = [&random] { return random() % 2 == 0; };
  p.far_popcount = coin();
  p.negative_t = coin();
  p.positive_normals = coin();
  p.tm_wrap = coin();
  p.stale_miss = coin();
  p.stack_depth = random() % 4 == 0 ? 1 + random() % 4 : 11;
  if (random() % 2 == 0) p.format = {2 + static_cast<unsigned>(random() % 31), 1 + static_cast<unsigned>(random() % 32)};
  return p;
}

svo_image random_image(rng& random) {
  svo_image image;
  if (random() % 8 == 0) {  // noise: whatever the words, the machine must go its way
    image.words.resize(1 + random() % 200);
    for (auto& w : image.words) w = random() % 2 == 0 ? random() & 0x000fffff : random();
    return image;
  }
  const unsigned levels = 1 + random() % 6;
  image.words = {0};
  std::vector<std::uint32_t> level{0};
  for (unsigned l = 0; l < levels && !level.empty(); ++l) {
    std::vector<std::uint32_t> below;
    for (const std::uint32_t entry : level) {
      const std::uint32_t valid = random() & 0xff;
      std::uint32_t leaf = valid & (random() | (random() % 4 == 0 ? 0xffu : 0u));
      if (l + 1 == levels || image.words.size() > 4'000) leaf = valid;
      const auto children = static_cast<std::uint32_t>(__builtin_popcount(valid & ~leaf));
      const bool far = random() % 4 == 0;
      if (far) image.words.push_back(0);
      const auto group = static_cast<std::uint32_t>(image.words.size());
      for (std::uint32_t c = 0; c < children; ++c) below.push_back(group + c);
      image.words.resize(image.words.size() + children);
      if (far) image.words[group - 1] = group - entry;
      image.words[entry] = make_descriptor(far, far ? group - 1 - entry : children == 0 ? 0 : group - entry, valid, leaf);
    }
    level = below;
  }
  return image;
}

traversal_job random_job(rng& random, const numeric::fixed_format& format, std::uint32_t words) {
  traversal_job job;
  job.job_word = random();
  if (random() % 8 == 0) job.address = random() % (words + 2);
  if (random() % 4 == 0) {
    for (unsigned i = 0; i < 3; ++i) {
      job.t0[i] = numeric::wrap(static_cast<std::int64_t>(random()) << (random() % 32), format.width());
      job.t1[i] = numeric::wrap(static_cast<std::int64_t>(random()) << (random() % 32), format.width());
    }
    return job;
  }
  const job_packet packet = random_ray(random, 0);
  numeric::float_to_fixed_stats stats;
  job.job_word = packet.job_word;
  for (unsigned i = 0; i < 3; ++i) {
    job.t0[i] = numeric::float_to_fixed(packet.t0[i], format, {}, stats);
    job.t1[i] = numeric::float_to_fixed(packet.t1[i], format, {}, stats);
  }
  return job;
}

job_packet random_packet(rng& random, std::uint32_t id) {
  if (random() % 8 != 0) return random_ray(random, id);
  job_packet p;
  p.job_word = (random() & ~job_id_mask) | (id & job_id_mask);
  for (unsigned i = 0; i < 3; ++i) {
    p.t0[i] = random();
    p.t1[i] = random();
  }
  return p;
}

}  // namespace rtusim::test
