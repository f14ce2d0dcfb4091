#include "testbench/run/job_file.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/config/files.h"

namespace rtusim {
namespace {

constexpr std::size_t packet_bytes = 32;
constexpr std::size_t packets_a_write = 4096;

std::uint32_t word_at(const char* bytes) {
  std::uint32_t word = 0;
  for (unsigned i = 0; i < 4; ++i) word |= std::uint32_t{static_cast<unsigned char>(bytes[i])} << 8 * i;
  return word;
}

char* put_word(char* bytes, std::uint32_t word) {
  for (unsigned i = 0; i < 4; ++i) *bytes++ = static_cast<char>(word >> 8 * i & 0xff);
  return bytes;
}

}  // namespace

std::vector<job_packet> read_jobs(const std::filesystem::path& file) {
  const std::string bytes = config::read_file(file);
  if (bytes.empty()) throw input_error(file.string(), "no jobs", fmt::format("packets of {} bytes", packet_bytes));
  if (bytes.size() % packet_bytes != 0)
    throw input_error(file.string(), fmt::format("{} bytes", bytes.size()),
                      fmt::format("a multiple of {}, the size of a job packet", packet_bytes));

  std::vector<job_packet> jobs(bytes.size() / packet_bytes);
  const char* from = bytes.data();
  for (job_packet& job : jobs) {
    job.job_word = word_at(from);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      job.t0[axis] = word_at(from + 4 + 4 * axis);
      job.t1[axis] = word_at(from + 16 + 4 * axis);
    }
    job.address = word_at(from + 28);
    from += packet_bytes;
  }
  return jobs;
}

void write_jobs(const std::filesystem::path& file, const std::vector<job_packet>& jobs) {
  config::output_file out(file);
  std::string bytes(packet_bytes * packets_a_write, '\0');
  for (std::size_t first = 0; first < jobs.size(); first += packets_a_write) {
    const std::size_t past = std::min(first + packets_a_write, jobs.size());
    char* to = bytes.data();
    for (std::size_t i = first; i < past; ++i) {
      const job_packet& job = jobs[i];
      to = put_word(to, job.job_word);
      for (const std::uint32_t t : job.t0) to = put_word(to, t);
      for (const std::uint32_t t : job.t1) to = put_word(to, t);
      to = put_word(to, job.address);
    }
    out.write(std::string_view(bytes).substr(0, packet_bytes * (past - first)));
  }
  out.commit();
}

}  // namespace rtusim
