#include "scenes/rays/ray_list.h"

#include <charconv>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>

#include "modules/config/csv.h"
#include "modules/config/endings.h"
#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/config/words.h"

namespace rtusim {
namespace {

constexpr std::array<const char*, 6> columns{"ox", "oy", "oz", "dx", "dy", "dz"};

float& component(ray_list::ray& r, std::size_t i) { return i < 3 ? r.origin[i] : r.direction[i - 3]; }

/// The nearest binary32. False for what is no number or beyond its range; what is too small for it is 0.
bool read_component(std::string_view text, float& value) {
  text = without_plus(text);
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, value);
  if (error != std::errc::result_out_of_range) return error == std::errc{} && end == last;
  double wide = 0;
  const auto wider = std::from_chars(text.data(), last, wide);
  value = text.front() == '-' ? -0.0f : 0.0f;
  return wider.ec == std::errc{} && wider.ptr == last && std::fabs(wide) < 1;
}

std::vector<ray_list::ray> read_text(const std::filesystem::path& file) {
  const csv_table table(file);
  std::array<std::size_t, columns.size()> places{};
  for (std::size_t i = 0; i < columns.size(); ++i) places[i] = table.column(columns[i]);
  std::vector<ray_list::ray> rays(table.rows());
  for (std::size_t row = 0; row < rays.size(); ++row)
    for (std::size_t i = 0; i < columns.size(); ++i)
      if (const auto text = table.field(row, places[i]); !read_component(text, component(rays[row], i)))
        throw input_error(fmt::format("{}:{}", file.string(), row + 2), fmt::format("{} = \"{}\"", columns[i], text.substr(0, 40)),
                          "a number within binary32, inf or nan");
  return rays;
}

std::vector<ray_list::ray> read_words(const std::filesystem::path& file) {
  const std::string bytes = config::read_file(file);
  constexpr std::size_t ray_bytes = 4 * columns.size();
  if (bytes.size() % ray_bytes != 0)
    throw input_error(file.string(), fmt::format("{} bytes", bytes.size()), fmt::format("a multiple of {}, the size of a ray", ray_bytes));
  std::vector<ray_list::ray> rays(bytes.size() / ray_bytes);
  const char* from = bytes.data();
  for (ray_list::ray& r : rays)
    for (std::size_t i = 0; i < columns.size(); ++i) {
      std::uint32_t word = 0;
      for (unsigned b = 0; b < 4; ++b) word |= std::uint32_t{static_cast<unsigned char>(*from++)} << 8 * b;
      std::memcpy(&component(r, i), &word, sizeof word);
    }
  return rays;
}

}  // namespace

ray_list::ray_list(const std::filesystem::path& file) {
  const std::string ending = config::unzipped_ending_of(file);
  if (ending != ".csv" && ending != ".bin")
    throw input_error(file.string(), fmt::format("a ray list ending in \"{}\"", ending), ".csv or .bin, zipped (.gz) or not");
  rays_ = ending == ".csv" ? read_text(file) : read_words(file);
  if (rays_.empty()) throw input_error(file.string(), "no rays", "origin and direction of one at least");
}

}  // namespace rtusim
