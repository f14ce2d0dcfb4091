#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "modules/formats/packets.h"

namespace rtusim {

/// The job packets of a file: eight little-endian 32-bit words each (job word, t0 x y z, t1 x y z, address), one after the other,
/// zipped by gzip or not. Any word is a word: NaN, infinities and ids without order are the hardware's to judge.
/// Errors: input_error for a file that can't be read, is empty, or ends within a packet.
std::vector<job_packet> read_jobs(const std::filesystem::path& file);

/// Writes that file, unzipped; appears under its name only when whole.
/// Errors: input_error where it can't be written.
void write_jobs(const std::filesystem::path& file, const std::vector<job_packet>& jobs);

}  // namespace rtusim
