#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace rtusim::config {

/// Inclusive limits of a number.
template <class T>
struct range {
  T least = std::numeric_limits<T>::lowest();
  T most = std::numeric_limits<T>::max();
};

/// The words of an enumeration, in the order of its enumerators, which count from 0.
using word_list = std::vector<std::string_view>;

/// An enumeration seen as an index into its words.
struct choice_slot {
  word_list words;
  std::function<unsigned()> get;
  std::function<void(unsigned)> set;
};

/// Where a parameter's value lives and what values it may take.
struct unsigned_slot {
  std::uint64_t (*get)(const void*);
  void (*set)(void*, std::uint64_t);
  void* at;
  range<std::uint64_t> limits;
  std::string_view word;    ///< what may stand in place of a number: `auto`; empty: nothing may
  bool* is_word = nullptr;  ///< whether it does
};
struct flag_slot {
  bool* at;
};
struct real_slot {
  double* at;
  range<double> limits;
};
struct text_slot {
  std::string* at;
};
struct vector_slot {
  std::array<double, 3>* at;
  range<double> limits;
};

/// One parameter: a described field of a unit's `params`.
struct parameter {
  std::string key;    ///< `scheduler.policy`
  std::string alias;  ///< `errata.NAME` for an erratum, else empty
  std::string unit;   ///< `cycles`, `MHz`; empty for a pure number
  std::string meaning;
  std::variant<unsigned_slot, flag_slot, real_slot, text_slot, vector_slot, choice_slot> slot;
  std::function<bool()> is_read;  ///< whether the design as it now stands reads this value; empty: always
  std::string read_when;          ///< the same in words: `source.valid = gap`

  /// `word` may stand in place of the number, and then `is_word` is true. A number's only.
  parameter& or_word(std::string_view word, bool& is_word, std::string_view its_meaning) {
    auto& number = std::get<unsigned_slot>(slot);
    number.word = word;
    number.is_word = &is_word;
    meaning += "; " + std::string(word) + ": " + std::string(its_meaning);
    return *this;
  }

  /// The value is read only while `condition` holds; `words` says when, for the error message and `explain`.
  parameter& when(std::function<bool()> condition, std::string words) {
    is_read = std::move(condition);
    read_when = std::move(words);
    return *this;
  }
};

/// The list into which a `params` struct describes its fields: each one's key, unit, range and meaning.
///
///     struct params {
///       order leave = order::as_finished;
///       void describe(config::section& s) {
///         s.choice("order", leave, order_words(), "how results leave");
///       }
///     };
///
/// A value at the time of the description is its default. From this list come the TOML reader, the range checks, `--set`,
/// `rtusim explain` and the record of a run. The described struct must outlive the section and not move.
class section {
 public:
  explicit section(std::string name) : name_(std::move(name)) {}

  template <class Unsigned>
  parameter& number(std::string_view field, Unsigned& at, range<std::uint64_t> limits, std::string_view unit, std::string_view meaning) {
    static_assert(std::is_unsigned_v<Unsigned> && !std::is_same_v<Unsigned, bool>);
    limits.most = std::min<std::uint64_t>(limits.most, std::numeric_limits<Unsigned>::max());
    return add(field, unit, meaning,
               unsigned_slot{[](const void* p) -> std::uint64_t { return *static_cast<const Unsigned*>(p); },
                             [](void* p, std::uint64_t v) { *static_cast<Unsigned*>(p) = static_cast<Unsigned>(v); },
                             &at,
                             limits,
                             {},
                             nullptr});
  }
  parameter& flag(std::string_view field, bool& at, std::string_view meaning) { return add(field, "", meaning, flag_slot{&at}); }
  parameter& real(std::string_view field, double& at, range<double> limits, std::string_view unit, std::string_view meaning) {
    return add(field, unit, meaning, real_slot{&at, limits});
  }
  parameter& text(std::string_view field, std::string& at, std::string_view meaning) { return add(field, "", meaning, text_slot{&at}); }
  parameter& vector(std::string_view field, std::array<double, 3>& at, range<double> limits, std::string_view unit,
                    std::string_view meaning) {
    return add(field, unit, meaning, vector_slot{&at, limits});
  }
  /// One of `words`: an enumeration, or an index.
  template <class Enum>
  parameter& choice(std::string_view field, Enum& at, word_list words, std::string_view meaning) {
    return add(
        field, "", meaning,
        choice_slot{std::move(words), [&at] { return static_cast<unsigned>(at); }, [&at](unsigned i) { at = static_cast<Enum>(i); }});
  }
  /// A switch between what was built (true) and what is right (false, the default); `errata.NAME` is its alias.
  parameter& erratum(std::string_view field, bool& at, std::string_view as_built, std::string_view right) {
    auto& p = add(field, "", "as built: " + std::string(as_built) + "; right: " + std::string(right), flag_slot{&at});
    p.alias = "errata." + std::string(field);
    return p;
  }

  const std::string& name() const { return name_; }
  std::vector<parameter>& parameters() { return parameters_; }
  const std::vector<parameter>& parameters() const { return parameters_; }

 private:
  template <class Slot>
  parameter& add(std::string_view field, std::string_view unit, std::string_view meaning, Slot slot) {
    parameters_.push_back({name_ + '.' + std::string(field), {}, std::string(unit), std::string(meaning), std::move(slot), {}, {}});
    return parameters_.back();
  }

  std::string name_;
  std::vector<parameter> parameters_;
};

}  // namespace rtusim::config
