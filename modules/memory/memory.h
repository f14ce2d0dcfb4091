#pragma once

#include <cstdint>
#include <vector>

#include <systemc>

#include "modules/config/section.h"
#include "modules/formats/word_view.h"

namespace rtusim {

/// What a core sees of the memory that holds the models.
class memory_interface : public virtual sc_core::sc_interface {
 public:
  /// The words as they can be read without time passing.
  virtual word_view words() const = 0;
};

/// The model memory (Espe 2019, sec. 6.2.4). Kind `lut`: distributed RAM with a port for each core, read combinationally in the clock in
/// which the address register holds the address; it never makes a core wait.
class memory : public sc_core::sc_module, public memory_interface {
 public:
  enum class kind : std::uint8_t { lut };
  static config::word_list kind_words() { return {"lut"}; }

  struct params {
    kind which = kind::lut;
    unsigned address_bits = 20;

    void describe(config::section& s);
  };

  /// `image` must outlive the memory.
  memory(const sc_core::sc_module_name& name, const params& p, const std::vector<std::uint32_t>& image);

  word_view words() const override { return words_; }

 private:
  word_view words_;
};

/// An image as a memory of these parameters holds it: words beyond its end read 0, a longer one is cut.
word_view view_of(const std::vector<std::uint32_t>& image, const memory::params& p);

}  // namespace rtusim
