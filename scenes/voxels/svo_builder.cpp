#include "scenes/voxels/svo_builder.h"

#include <algorithm>
#include <array>
#include <utility>

#include "modules/config/error.h"

namespace rtusim {
namespace {

constexpr std::uint32_t empty_cube = make_descriptor(false, 0, 0, 0);
constexpr std::uint32_t full_cube = make_descriptor(false, 0, 0xff, 0xff);
constexpr std::uint32_t pointer_one = make_descriptor(false, 1, 0, 0);

// Whether the unit as built finds each child of a descriptor behind a far word that holds `offset`.
bool counts_alike(std::uint32_t word, std::uint64_t offset) {
  // As built the far word's bits 14:8 are taken for the valid mask and 6:0 for the leaf mask.
  const auto as_built = static_cast<std::uint32_t>((offset >> 8) & ~offset & 0x7f);
  for (unsigned slot = 0; slot < 8; ++slot) {
    if (((node_mask(word) >> slot) & 1) == 0) continue;
    const std::uint32_t before = as_built & ((std::uint32_t{1} << slot) - 1);
    if (static_cast<unsigned>(__builtin_popcount(before)) != child_nodes_before(word, slot)) return false;
  }
  return true;
}

// Lays an image from its end to its beginning: when a group is laid, the sizes of the subtrees that follow it are known, and as
// pointers are relative, what has been laid stays as it is.
class layer {
 public:
  layer(const voxel_grid& grid, const svo_layout& layout) : blocks_(grid.blocks()), layout_(layout) {}

  svo_image image(unsigned levels) {
    std::uint32_t root = lay_below(levels, 0);
    if (child_nodes(root) != 0) root |= pointer_one;
    reversed_.push_back(root);
    std::reverse(reversed_.begin(), reversed_.end());
    return {std::move(reversed_)};
  }

 private:
  // A child that has a word of its own.
  struct node {
    std::uint32_t word;     // without pointer
    std::size_t group_end;  // how many words were laid when its own group was
  };

  // Lays all that is below a cube of 8^level voxels, number `index` of them; returns its descriptor, without pointer.
  std::uint32_t lay_below(unsigned level, std::uint64_t index) {
    if (level == 1) {
      const auto filled = static_cast<std::uint32_t>((blocks_[index / 8] >> (index % 8 * 8)) & 0xff);
      return make_descriptor(false, 0, filled, filled);
    }
    if (level == 2 && blocks_[index] == 0) return empty_cube;
    std::uint32_t valid = 0, leaf = 0;
    std::array<node, 8> last_first{};
    std::size_t nodes = 0;
    for (unsigned c = 8; c-- > 0;) {
      const std::uint32_t child = lay_below(level - 1, index * 8 + c);
      if (child == empty_cube) continue;
      valid |= 1U << c;
      if (child == full_cube)
        leaf |= 1U << c;
      else
        last_first[nodes++] = {child, reversed_.size()};
    }
    lay_group(last_first.data(), nodes);
    return make_descriptor(false, 0, valid, leaf);
  }

  // Lays the far words and the words of a group whose subtrees have just been laid; last_first[k] has k words of the group behind it.
  void lay_group(const node* last_first, std::size_t nodes) {
    std::vector<std::uint32_t> far_words;
    for (std::size_t reserved = 0;; reserved = far_words.size()) {
      // Each far word moves the subtrees away by one more, so that another child may need one.
      far_words.clear();
      std::uint64_t all_padding = 0;
      for (std::size_t k = nodes; k-- > 0;) {
        const std::uint64_t offset = offset_to_group(last_first[k], k, reserved) + all_padding;
        if (child_nodes(last_first[k].word) == 0 || offset <= max_child_pointer) continue;
        const std::uint64_t padding = padding_for(last_first[k].word, offset);
        all_padding += padding;
        far_words.push_back(static_cast<std::uint32_t>(offset + padding));
      }
      if (far_words.size() <= reserved) {
        far_words.resize(reserved);
        break;
      }
    }

    std::array<std::uint32_t, 8> words{};
    std::size_t far_words_used = 0;
    for (std::size_t k = nodes; k-- > 0;) {
      words[k] = last_first[k].word;
      if (child_nodes(words[k]) == 0) continue;
      std::uint64_t pointer = offset_to_group(last_first[k], k, far_words.size());
      const bool far = pointer > max_child_pointer;
      if (far) {
        const std::uint64_t padding = far_words[far_words_used] - pointer;
        reversed_.insert(reversed_.begin() + static_cast<std::ptrdiff_t>(last_first[k].group_end), padding, 0);
        pointer = k + 1 + far_words_used++;
      }
      words[k] |= make_descriptor(far, static_cast<std::uint32_t>(pointer), 0, 0);
    }
    reversed_.insert(reversed_.end(), far_words.rbegin(), far_words.rend());
    reversed_.insert(reversed_.end(), words.begin(), words.begin() + static_cast<std::ptrdiff_t>(nodes));
  }

  // From the word of a node to its group, with what is laid by now and so many far words yet to be laid.
  std::uint64_t offset_to_group(const node& n, std::size_t words_behind, std::size_t far_words) const {
    return words_behind + 1 + far_words + (reversed_.size() - n.group_end);
  }

  // Unused words before a far group.
  std::uint64_t padding_for(std::uint32_t word, std::uint64_t offset) const {
    std::uint64_t padding = 0;
    // Ends: an offset with node_mask in bits 14:8 and 0 below counts alike.
    while (layout_.far_as_built && !counts_alike(word, offset + padding)) ++padding;
    return padding;
  }

  const std::vector<std::uint64_t>& blocks_;
  svo_layout layout_;
  std::vector<std::uint32_t> reversed_;
};

// Fills a grid with what an image holds.
class filler {
 public:
  filler(const svo_image& image, voxel_grid& grid) : image_(image), grid_(grid) {}

  // Fills the voxels below the descriptor at `entry`, whose cube is number `index` of those of 8^level voxels.
  void fill_below(std::uint64_t entry, unsigned level, std::uint32_t index) {
    if (level == 0) {
      if (holds_leaf(entry)) grid_.fill_cube(0, index);
      return;
    }
    const std::uint32_t word = image_.words[entry];
    std::uint64_t child = child_nodes(word) == 0 ? 0 : child_group(image_, entry);
    for (unsigned c = 0; c < 8; ++c) {
      if (!is_valid(word, c)) continue;
      if (is_leaf(word, c))
        grid_.fill_cube(level - 1, index * 8 + c);
      else
        fill_below(child++, level - 1, index * 8 + c);
    }
  }
  // Whether descriptors came that are finer than voxels.
  bool met_finer() const { return !answers_.empty(); }

 private:
  enum class answer : std::uint8_t { unknown, no, yes };

  // Whether there is a leaf in the descriptor's cube. Asks each once, as subtrees may be shared.
  bool holds_leaf(std::uint64_t entry) {
    if (answers_.empty()) answers_.resize(image_.words.size());
    if (answers_[entry] != answer::unknown) return answers_[entry] == answer::yes;
    const std::uint32_t word = image_.words[entry];
    bool held = leaf_mask(word) != 0;
    const std::uint64_t group = child_nodes(word) == 0 ? 0 : child_group(image_, entry);
    for (unsigned child = 0; child < child_nodes(word) && !held; ++child) held = holds_leaf(group + child);
    answers_[entry] = held ? answer::yes : answer::no;
    return held;
  }

  const svo_image& image_;
  voxel_grid& grid_;
  std::vector<answer> answers_;
};

}  // namespace

svo_image build_svo(const voxel_grid& grid, const std::string& place, const svo_layout& layout) {
  svo_image image = layer(grid, layout).image(grid.levels());
  if (image.words[0] == empty_cube) throw input_error(place, "no voxel is filled", "a model with something to hit");
  return image;
}

voxel_grid voxels_of(const svo_image& image, unsigned resolution) {
  voxel_grid grid(resolution);
  filler f(image, grid);
  f.fill_below(0, grid.levels(), 0);
  RTU_CHECK(f.met_finer(), ==, false);
  return grid;
}

voxel_grid coarse_voxels_of(const svo_image& image, unsigned resolution) {
  voxel_grid grid(resolution);
  filler(image, grid).fill_below(0, grid.levels(), 0);
  return grid;
}

}  // namespace rtusim
