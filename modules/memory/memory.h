#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <systemc>

#include "modules/config/report.h"
#include "modules/config/section.h"
#include "modules/formats/word_view.h"
#include "modules/timing/unit.h"

namespace rtusim {

/// Who reads words of a memory.
class memory_reader {
 public:
  virtual ~memory_reader() = default;
  /// How many so far, of all cycles before the next edge.
  virtual std::uint64_t fetches() = 0;
};

/// What a core sees of the memory that holds the models.
class memory_interface : public virtual sc_core::sc_interface {
 public:
  /// The words as they can be read without time passing.
  virtual word_view words() const = 0;
  /// Lets the memory ask `reader`, which must outlive it, what it has read.
  virtual void attach(memory_reader& reader) = 0;
};

/// The model memory (Espe 2019, sec. 6.2.4). Kind `lut`: distributed RAM with a port for each core, read combinationally in the cycle in
/// which the address register holds the address; it never makes a core wait.
class memory final : public unit, public memory_interface {
 public:
  enum class kind : std::uint8_t { lut };
  static config::word_list kind_words() { return {"lut"}; }

  struct params {
    kind which = kind::lut;
    unsigned address_bits = 20;

    void describe(config::section& s);
  };

  struct stats {
    std::uint64_t fetches = 0;

    void describe(config::report& r) const;
  };

  /// `image` must outlive the memory.
  memory(const sc_core::sc_module_name& name, const params& p, const std::vector<std::uint32_t>& image);

  word_view words() const override { return words_; }
  void attach(memory_reader& reader) override { readers_.push_back(&reader); }
  stats statistics();
  std::unique_ptr<unit_figures> figures() override { return as_figures(statistics()); }

 private:
  // Read within the cycle, it has no register.
  void reset() override {}
  bool level(const channel_base&) const override { return false; }
  void trace(waveform&) const override {}

  word_view words_;
  std::vector<memory_reader*> readers_;
};

/// An image as a memory of these parameters holds it: words beyond its end read 0, a longer one is cut.
word_view view_of(const std::vector<std::uint32_t>& image, const memory::params& p);

}  // namespace rtusim
