#include "modules/memory/memory.h"

#include <algorithm>

namespace rtusim {

memory::memory(const sc_core::sc_module_name& name, const params& p, const std::vector<std::uint32_t>& image)
    : unit(name), words_(view_of(image, p)) {}

word_view view_of(const std::vector<std::uint32_t>& image, const memory::params& p) {
  const std::uint64_t words = std::uint64_t{1} << p.address_bits;
  return {image.data(), static_cast<std::uint32_t>(std::min<std::uint64_t>(image.size(), words)), static_cast<std::uint32_t>(words - 1)};
}

memory::stats memory::statistics() {
  stats s;
  for (memory_reader* const reader : readers_) s.fetches += reader->fetches();
  return s;
}

void memory::stats::describe(config::report& r) const {
  r.number("fetches", fetches, "words", "descriptors that the cores fetched; not the words of far pointers behind them");
}

void memory::params::describe(config::section& s) {
  s.choice("kind", which, kind_words(), "lut: distributed RAM with a port for each core, no waiting");
  s.number("address_bits", address_bits, {1, 30}, "bits", "width of a word address; addresses count modulo 2^address_bits");
}

}  // namespace rtusim
