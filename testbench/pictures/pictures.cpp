#include "testbench/pictures/pictures.h"

#include <algorithm>
#include <cctype>
#include <future>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/config/schema.h"
#include "testbench/pictures/picture_library.h"
#include "testbench/pictures/picture_writer.h"

namespace rtusim {
namespace {

constexpr const char* known_names =
    "NAME.png (shaded), NAME.lit.png, NAME.depth.png, NAME.normal.png, NAME.cost.png, NAME.heat.png, NAME.latency.png, NAME.wait.png, "
    "NAME.core.png, NAME.model.png, NAME.sheet.png (all of them) or NAME.exr (all layers)";
constexpr std::pair<std::string_view, picture_kind> words[] = {
    {"", picture_kind::shaded},    {".lit", picture_kind::lit},     {".depth", picture_kind::depth}, {".normal", picture_kind::normal},
    {".cost", picture_kind::cost}, {".heat", picture_kind::heat},   {".wait", picture_kind::wait},   {".latency", picture_kind::latency},
    {".core", picture_kind::core}, {".model", picture_kind::model}, {".sheet", picture_kind::sheet}};

using picture_writer = decltype(&rtusim_write_picture);

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

picture_writer load_writer() { return reinterpret_cast<picture_writer>(picture_function("rtusim_write_picture")); }

/// Loads once; the first caller decides on which thread.
std::shared_future<picture_writer>& writer(std::launch how) {
  static std::shared_future<picture_writer> loaded = std::async(how, load_writer).share();
  return loaded;
}

}  // namespace

picture_kind kind_of(const std::filesystem::path& file) {
  const std::string ending = lower_case(file.extension().string());
  if (ending == ".exr") return picture_kind::layers;
  if (ending != ".png") throw input_error(file.string(), "no picture format that we write", known_names);
  const std::string word = lower_case(file.stem().extension().string());
  std::vector<std::string> kinds;
  for (const auto& [known, kind] : words) {
    if (word == known) return kind;
    kinds.emplace_back(known);
  }
  const std::string near = config::nearest(word, kinds);
  if (near.empty()) return picture_kind::shaded;
  throw input_error(file.string(), fmt::format("unknown kind of picture \"{}\"", word.substr(1)),
                    fmt::format("NAME{}.png, or another name", near));
}

bool shows_places(picture_kind kind) {
  return kind == picture_kind::lit || kind == picture_kind::model || kind == picture_kind::sheet || kind == picture_kind::layers;
}

picture_preparation::picture_preparation(bool wanted) : wanted_(wanted) {
  if (wanted_) writer(std::launch::async);
}

picture_preparation::~picture_preparation() {
  if (wanted_) writer(std::launch::async).wait();
}

void write_picture(const std::filesystem::path& file, const frame& picture, picture_kind kind, const picture_text& text) {
  const picture_writer write = writer(std::launch::deferred).get();
  config::output_file out(file);
  write({file.string(), out.descriptor()}, picture, kind, text);
  out.commit();
}

}  // namespace rtusim
