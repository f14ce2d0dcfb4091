#pragma once

#include "modules/config/section.h"
#include "modules/core_bank/core_kind.h"
#include "modules/core_bank/kind_list.h"

namespace rtusim {

/// The list of all kinds of cores.
kind_list<core_kind>& core_kinds();

/// Their words.
config::word_list core_words();

}  // namespace rtusim
