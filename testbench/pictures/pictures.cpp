#include "testbench/pictures/pictures.h"

#include <algorithm>
#include <cctype>
#include <future>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "modules/config/alternatives.h"
#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/config/schema.h"
#include "testbench/pictures/picture_library.h"
#include "testbench/pictures/picture_writer.h"

namespace rtusim {
namespace {

struct picture_word {
  std::string_view word;  // of NAME.WORD.png
  picture_kind kind;
  bool shows_places = false;
};
constexpr picture_word words[] = {{"", picture_kind::shaded},           {"lit", picture_kind::lit, true},    {"depth", picture_kind::depth},
                                  {"normal", picture_kind::normal},     {"cost", picture_kind::cost},        {"heat", picture_kind::heat},
                                  {"latency", picture_kind::latency},   {"wait", picture_kind::wait},        {"core", picture_kind::core},
                                  {"model", picture_kind::model, true}, {"sheet", picture_kind::sheet, true}};

/// `NAME.png (shaded), NAME.lit.png, ...`
std::string known_names() {
  std::string text;
  for (const picture_word& w : words) {
    if (w.word.empty())
      text += "NAME.png (shaded)";
    else
      text += fmt::format(", NAME.{}.png{}", w.word, w.kind == picture_kind::sheet ? " (all of them)" : "");
  }
  return text + " or NAME.exr (all layers)";
}

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
  if (ending != ".png") throw input_error(file.string(), "no picture format that we write", known_names());
  const std::string word = lower_case(file.stem().extension().string());
  std::vector<std::string> kinds;
  for (const picture_word& w : words) {
    kinds.push_back(w.word.empty() ? "" : "." + std::string(w.word));
    if (word == kinds.back()) return w.kind;
  }
  const std::string near = config::nearest(word, kinds);
  if (near.empty()) return picture_kind::shaded;
  throw input_error(file.string(), fmt::format("unknown kind of picture \"{}\"", word.substr(1)),
                    fmt::format("NAME{}.png, or another name", near));
}

bool shows_places(picture_kind kind) {
  const auto found = std::find_if(std::begin(words), std::end(words), [kind](const picture_word& w) { return w.kind == kind; });
  return found == std::end(words) || found->shows_places;  // all layers have them, too
}

std::string picture_words() {
  std::vector<std::string_view> all;
  for (const picture_word& w : words)
    if (!w.word.empty() && w.kind != picture_kind::sheet) all.push_back(w.word);
  return config::alternatives(all);
}

picture_preparation::picture_preparation(bool wanted) : wanted_(wanted) {
  if (wanted_) writer(std::launch::async | std::launch::deferred);
}

picture_preparation::~picture_preparation() {
  if (wanted_) writer(std::launch::async | std::launch::deferred).wait();
}

void write_picture(const std::filesystem::path& file, const frame& picture, picture_kind kind, const picture_text& text) {
  const picture_writer write = writer(std::launch::deferred).get();
  config::output_file out(file);
  write({file.string(), out.descriptor()}, picture, kind, text);
  out.commit();
}

}  // namespace rtusim
