#include "modules/formats/svo_image.h"

#include <algorithm>
#include <cmath>

#include "modules/config/error.h"
#include "modules/config/files.h"

namespace rtusim {
namespace {

constexpr std::size_t word_bytes = 4;
constexpr unsigned max_stack_depth = 20;  // the voxels of 21 levels can be counted in 64 bits

std::string word_place(const std::string& place, std::uint64_t index) { return fmt::format("{}: word {}", place, index); }

// A descriptor on the way from the root to the present one.
struct visit {
  std::uint32_t entry;
  std::uint64_t group;
  unsigned nodes;
  unsigned next = 0;     // child to look at
  unsigned deepest = 0;  // levels below, of the children seen so far
};

visit enter(const svo_image& image, std::uint32_t entry, const std::string& place) {
  const std::uint32_t word = image.words[entry];
  const std::uint64_t size = image.words.size();
  if ((leaf_mask(word) & ~valid_mask(word)) != 0)
    throw input_error(word_place(place, entry), fmt::format("leaf mask {:#04x}, valid mask {:#04x}", leaf_mask(word), valid_mask(word)),
                      "leaves among the valid children");
  const unsigned nodes = child_nodes(word);
  if (nodes == 0) return {entry, 0, 0};  // the pointer is never followed
  const std::uint64_t target = std::uint64_t{entry} + child_pointer(word);
  if (is_far(word) && target >= size)
    throw input_error(word_place(place, entry), fmt::format("its far word is word {}", target),
                      fmt::format("a far word inside of the image of {} words", size));
  const std::uint64_t group = child_group(image, entry);
  if (group + nodes > size)
    throw input_error(word_place(place, entry), fmt::format("its children are words {} to {}", group, group + nodes - 1),
                      fmt::format("children inside of the image of {} words", size));
  return {entry, group, nodes};
}

// The descriptors that the root leads to, each once, children before parents. Checks all that check_svo promises.
std::vector<std::uint32_t> children_first(const svo_image& image, const std::string& place, const svo_limits& limits) {
  RTU_CHECK(limits.address_bits, <=, 32U);
  RTU_CHECK(limits.stack_depth, <=, max_stack_depth);
  const std::uint64_t size = image.words.size();
  const std::uint64_t most_words = std::uint64_t{1} << limits.address_bits;
  const unsigned most_levels = limits.stack_depth + 1;
  if (size == 0) throw input_error(place, "an empty image", "at least the root's descriptor");
  if (size > most_words)
    throw input_error(place, fmt::format("an image of {} words", size),
                      fmt::format("at most {}, what {} address bits reach", most_words, limits.address_bits));

  constexpr std::uint8_t unseen = 0, on_path = 0xff;  // else the levels from this descriptor down
  std::vector<std::uint8_t> levels(size, unseen);
  std::vector<std::uint32_t> order;
  std::vector<visit> path{enter(image, 0, place)};
  levels[0] = on_path;
  while (!path.empty()) {
    visit& at = path.back();
    if (at.next == at.nodes) {
      const unsigned below = at.deepest + 1;
      levels[at.entry] = static_cast<std::uint8_t>(below);
      order.push_back(at.entry);
      path.pop_back();
      if (!path.empty()) path.back().deepest = std::max(path.back().deepest, below);
      continue;
    }
    const auto child = static_cast<std::uint32_t>(at.group + at.next++);
    if (levels[child] == on_path)
      throw input_error(word_place(place, at.entry), fmt::format("its child, word {}, is the word itself or one above it", child),
                        "an octree without loops");
    const auto reached = path.size() + std::max<std::size_t>(levels[child], 1);
    if (reached > most_levels)
      throw input_error(word_place(place, child), fmt::format("{} levels of descriptors from the root on", reached),
                        fmt::format("at most {}, for a stack of {}", most_levels, limits.stack_depth));
    if (levels[child] == unseen) {
      levels[child] = on_path;
      path.push_back(enter(image, child, place));
    } else {
      at.deepest = std::max<unsigned>(at.deepest, levels[child]);
    }
  }
  return order;
}

// The least and the greatest coordinate, along one axis, of what is filled of a descriptor's cube, in its edges: exact in binary32 up to
// 24 levels.
struct filled_span {
  float lower = 1, upper = 0;

  // Grows to hold that of the half in which a child's cube lies; an empty one changes nothing.
  void add(const filled_span& child, bool upper_half) {
    if (child.lower > child.upper) return;
    const float half = upper_half ? 0.5f : 0.0f;
    lower = std::min(lower, half + child.lower / 2);
    upper = std::max(upper, half + child.upper / 2);
  }
};

// That of an image; `order` has children before parents.
filled_span span_along(unsigned axis, const svo_image& image, const std::vector<std::uint32_t>& order) {
  std::vector<filled_span> spans(image.words.size());
  for (const std::uint32_t entry : order) {
    const std::uint32_t word = image.words[entry];
    std::uint64_t child = child_nodes(word) == 0 ? 0 : child_group(image, entry);
    for (unsigned slot = 0; slot < 8; ++slot)
      if (is_valid(word, slot)) spans[entry].add(is_leaf(word, slot) ? filled_span{0, 1} : spans[child++], ((slot >> axis) & 1) != 0);
  }
  return spans[0];
}

}  // namespace

svo_image read_svo(const std::filesystem::path& file, const svo_limits& limits) {
  RTU_CHECK(limits.address_bits, <=, 32U);
  // An image that is somewhat too large gets check_svo's message, which tells the reason.
  const std::uint64_t most_bytes = (std::uint64_t{word_bytes} << limits.address_bits) * 2 + word_bytes;
  const std::string bytes = config::read_file(file, most_bytes);
  if (bytes.empty() || bytes.size() % word_bytes != 0)
    throw input_error(file.string(), fmt::format("{} bytes", bytes.size()), "an SVO image, one or more 32-bit words");
  svo_image image;
  image.words.reserve(bytes.size() / word_bytes);
  for (std::size_t i = 0; i < bytes.size(); i += word_bytes) {
    std::uint32_t word = 0;
    for (std::size_t b = 0; b < word_bytes; ++b) word |= std::uint32_t{static_cast<unsigned char>(bytes[i + b])} << (8 * b);
    image.words.push_back(word);
  }
  check_svo(image, file.string(), limits);
  return image;
}

void check_svo(const svo_image& image, const std::string& place, const svo_limits& limits) { children_first(image, place, limits); }

void write_svo(const std::filesystem::path& file, const svo_image& image) {
  constexpr std::size_t chunk_bytes = std::size_t{1} << 20;
  config::output_file out(file);
  std::string chunk;
  for (const std::uint32_t word : image.words) {
    for (std::size_t b = 0; b < word_bytes; ++b) chunk.push_back(static_cast<char>((word >> (8 * b)) & 0xff));
    if (chunk.size() < chunk_bytes) continue;
    out.write(chunk);
    chunk.clear();
  }
  out.write(chunk);
  out.commit();
}

svo_summary describe(const svo_image& image, const std::string& place, const svo_limits& limits) {
  const auto order = children_first(image, place, limits);
  svo_summary summary;
  summary.bytes = image.words.size() * word_bytes;
  summary.nodes = order.size();

  std::vector<std::uint8_t> levels(image.words.size());
  std::vector<double> share(image.words.size());  // of the descriptor's own cube; exact in binary up to 17 levels
  std::vector<std::uint64_t> far_words;
  for (const std::uint32_t entry : order) {
    const std::uint32_t word = image.words[entry];
    const auto leaves = static_cast<unsigned>(__builtin_popcount(leaf_mask(word)));
    summary.leaves += leaves;
    std::uint8_t below = 0;
    double filled = leaves;
    if (const unsigned nodes = child_nodes(word); nodes != 0) {
      if (is_far(word)) far_words.push_back(std::uint64_t{entry} + child_pointer(word));
      const std::uint64_t group = child_group(image, entry);
      for (std::uint64_t child = group; child < group + nodes; ++child) {
        below = std::max(below, levels[child]);
        filled += share[child];
      }
    }
    levels[entry] = static_cast<std::uint8_t>(below + 1);
    share[entry] = filled / 8;
  }
  std::sort(far_words.begin(), far_words.end());
  summary.far_words = static_cast<std::uint64_t>(std::unique(far_words.begin(), far_words.end()) - far_words.begin());
  summary.levels = levels[0];
  summary.filled_share = share[0];
  summary.filled_voxels = static_cast<std::uint64_t>(std::ldexp(share[0], 3 * static_cast<int>(summary.levels)));
  for (unsigned k = 0; k < 3 && summary.leaves != 0; ++k) {
    const filled_span s = span_along(k, image, order);
    summary.lower[k] = s.lower;
    summary.upper[k] = s.upper;
  }
  return summary;
}

}  // namespace rtusim
