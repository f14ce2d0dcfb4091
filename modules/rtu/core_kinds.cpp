#include "modules/rtu/core_kinds.h"

#include "modules/bih_core/bih_kind.h"
#include "modules/svo_core/svo_kind.h"

namespace rtusim {

kind_list<core_kind>& core_kinds() {
  static auto all = kind_list<core_kind>::of<svo_kind, bih_kind>();
  return all;
}

config::word_list core_words() {
  config::word_list words;
  for (const auto& kind : core_kinds().make()) words.push_back(kind->word());
  return words;
}

}  // namespace rtusim
