#include "modules/formats/quantisation.h"

namespace rtusim {

void quantisation::describe(config::section& s) {
  s.number("n", n, {4, 32}, "bits", "coordinates: the scene's longest side is 2^n - 1 grid units");
  s.number("m", m, {4, 34}, "bits", "directions, normals and edges, signed");
  s.number("edge_shift", edge_shift, {0, greatest_edge_shift}, "bits", "E: edges lie in (-2^-E, 2^-E); longer ones are clamped")
      .or_word("auto", fit_edges, "the greatest that clamps no edge of the mesh");
  s.number("reciprocal_bits", reciprocal_bits, {0, 28}, "bits", "C: reciprocal directions have m + C bits, C of them after the point");
  s.number("division_drop", division_drop, {0, 24}, "bits", "T: low bits dropped from numerator and denominator before the division");
}

}  // namespace rtusim
