#include "modules/rtu/core_kinds.h"

#include "modules/bih_core/bih_kind.h"
#include "modules/svo_core/svo_kind.h"

namespace rtusim {
namespace {

using maker = std::unique_ptr<core_kind> (*)();

template <class Kind>
std::unique_ptr<core_kind> make() {
  return std::make_unique<Kind>();
}

/// The list of all kinds of cores.
std::vector<maker>& makers() {
  static std::vector<maker> all{&make<svo_kind>, &make<bih_kind>};
  return all;
}

}  // namespace

std::vector<std::unique_ptr<core_kind>> new_core_kinds() {
  std::vector<std::unique_ptr<core_kind>> kinds;
  for (const maker m : makers()) kinds.push_back(m());
  return kinds;
}

void add_core_kind(maker make) { makers().push_back(make); }

config::word_list core_words() {
  config::word_list words;
  for (const auto& kind : new_core_kinds()) words.push_back(kind->word());
  return words;
}

}  // namespace rtusim
