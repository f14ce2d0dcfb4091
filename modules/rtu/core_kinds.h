#pragma once

#include <memory>
#include <vector>

#include "modules/config/section.h"
#include "modules/core_bank/core_kind.h"

namespace rtusim {

/// One new object of each kind of core, with its default parameters, in the order of `rtu.core`'s words.
std::vector<std::unique_ptr<core_kind>> new_core_kinds();

/// Adds a kind to the list of this process, at its end; before the first design is made.
void add_core_kind(std::unique_ptr<core_kind> (*make)());

/// Their words.
config::word_list core_words();

}  // namespace rtusim
