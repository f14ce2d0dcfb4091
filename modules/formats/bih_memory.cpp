#include "modules/formats/bih_memory.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <string_view>
#include <system_error>

#include "modules/config/error.h"
#include "modules/config/files.h"

namespace rtusim {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t most_bytes = std::uint64_t{1} << 27;
constexpr std::uint64_t most_cycles = std::uint64_t{1} << 24;
constexpr unsigned triangle_fields = 10;
constexpr const char* field_names[triangle_fields] = {"pp", "pq", "d", "e1p", "e1q", "e2p", "e2q", "np", "nq", "r"};

/// What a word may hold.
struct word_range {
  unsigned bits;
  bool is_signed;
};

std::string described(const word_range& range) { return fmt::format("{} bits{}", range.bits, range.is_signed ? ", signed" : ""); }

/// The lines of one of the files, as words.
class word_file {
 public:
  word_file(const fs::path& folder, const std::string& name) {
    std::error_code ignored;
    file_ = folder / (name + ".txt");
    if (const fs::path zipped = folder / (name + ".txt.gz"); !fs::exists(file_, ignored) && fs::exists(zipped, ignored)) file_ = zipped;
  }

  bool exists() const {
    std::error_code ignored;
    return fs::exists(file_, ignored);
  }
  void open() {
    text_ = config::read_file(file_, most_bytes);
    rest_ = text_;
  }
  std::uint64_t lines() const {
    return static_cast<std::uint64_t>(std::count(text_.begin(), text_.end(), '\n')) + (text_.empty() || text_.back() == '\n' ? 0 : 1);
  }
  void expect_lines(std::uint64_t wanted, const std::string& of) const {
    if (lines() != wanted) throw input_error(file_.string(), fmt::format("{} lines", lines()), fmt::format("{}, {}", wanted, of));
  }
  bool next_line() {
    if (rest_.empty()) return false;
    ++number_;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    line_ = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    return true;
  }
  /// The blank-separated words of the line.
  std::vector<std::string_view> split() const {
    constexpr std::string_view blanks = " \t\r";
    std::vector<std::string_view> words;
    for (std::size_t at = line_.find_first_not_of(blanks); at < line_.size(); at = line_.find_first_not_of(blanks, at)) {
      const std::size_t end = std::min(line_.find_first_of(blanks, at), line_.size());
      words.push_back(line_.substr(at, end - at));
      at = end;
    }
    return words;
  }
  std::vector<std::string_view> split_into(std::size_t count) const {
    auto words = split();
    if (words.size() != count)
      throw input_error(place(), fmt::format("{} words", words.size()), count == 1 ? "one" : std::to_string(count));
    return words;
  }
  std::uint64_t word(std::string_view text) const {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
    if (end != text.data() + text.size() || error == std::errc::invalid_argument)
      throw input_error(place(), '"' + std::string(text.substr(0, 40)) + '"', "a hexadecimal number");
    if (error != std::errc{} || value > greatest_bih_word)
      throw input_error(place(), '"' + std::string(text.substr(0, 40)) + '"', fmt::format("a word of {} bits", bih_word_bits));
    return value;
  }
  std::int64_t value(std::string_view text, const char* name, const word_range& range) const {
    const auto value = static_cast<std::int64_t>(word(text) << (64 - bih_word_bits)) >> (64 - bih_word_bits);
    const std::int64_t limit = std::int64_t{1} << (range.is_signed ? range.bits - 1 : range.bits);
    if (value < (range.is_signed ? -limit : 0) || value >= limit)
      throw input_error(place(), fmt::format("{} = {}", name, text), described(range));
    return value;
  }
  std::string place() const { return fmt::format("{}:{}", file_.string(), number_); }

 private:
  fs::path file_;
  std::string text_;
  std::string_view rest_, line_;
  std::uint64_t number_ = 0;
};

std::int64_t* fields_of(accelerated_triangle& t, unsigned field) {
  std::int64_t* const fields[] = {&t.pp, &t.pq, &t.d, &t.e1p, &t.e1q, &t.e2p, &t.e2q, &t.np, &t.nq};
  return fields[field];
}

void write_lines(const fs::path& file, const std::string& text) {
  config::output_file out(file);
  out.write(text);
  out.commit();
}

/// What is known of a node once all below it is.
struct extent {
  std::uint64_t cycles = 0;  // NODE and all after it until the stack is as before
  std::uint64_t levels = 0;
  std::array<std::uint8_t, 8> stack_entries{};  // by the signs of the ray's direction: bit i set where it points down axis i
};

std::uint64_t capped_sum(std::uint64_t a, std::uint64_t b) { return std::min(a + b, std::numeric_limits<std::uint64_t>::max() / 4); }

class checker {
 public:
  checker(const bih_memory& memory, const std::string& place, const bih_rules& rules)
      : memory_(memory), place_(place), rules_(rules), end_(memory.stack_address()), extents_(end_), seen_(end_) {}

  bih_summary check() {
    enter(0);
    while (!path_.empty()) {
      visit& at = path_.back();
      if (at.next == at.children) {
        leave(at);
        path_.pop_back();
        continue;
      }
      const std::uint32_t child = at.left + at.next++;
      if (seen_[child] == on_path)
        throw input_error(node_place(), fmt::format("its child, node {}, is the node itself or one above it", child),
                          "a hierarchy without loops");
      if (seen_[child] == unseen) enter(child);
    }
    const extent& root = extents_[0];
    summary_.most_cycles = capped_sum(root.cycles, 1);
    summary_.levels = root.levels;
    summary_.stack_entries = *std::max_element(root.stack_entries.begin(), root.stack_entries.end());
    if (summary_.most_cycles > most_cycles)
      throw input_error(place_, fmt::format("a ray through it all would take {} cycles", summary_.most_cycles),
                        fmt::format("at most {}, with fewer shared subtrees or lists", most_cycles));
    if (!rules_.raw && summary_.stack_entries > most_bih_stack_entries) refuse_depth();
    return summary_;
  }

 private:
  // A node on the way from the root to the present one.
  struct visit {
    std::uint32_t node;
    std::uint32_t left = 0;
    unsigned children = 0;
    unsigned next = 0;
  };
  enum mark : std::uint8_t { unseen, on_path, done };

  void enter(std::uint32_t node) {
    seen_[node] = on_path;
    path_.push_back({node});
    const std::uint64_t word0 = memory_.words[0][node];
    const std::uint64_t pointer = rules_.raw ? node_pointer(word0) & memory_.address_mask() : node_pointer(word0);
    if (node_axis(word0) == bih_leaf) {
      check_leaf(node, pointer);
      return;
    }
    if (pointer + 1 >= end_)
      throw input_error(node_place(), fmt::format("its children are nodes {} and {}", pointer, pointer + 1),
                        fmt::format("nodes below {}, where the stack begins", end_));
    path_.back().left = static_cast<std::uint32_t>(pointer);
    path_.back().children = 2;
    ++summary_.inner_nodes;
  }

  void check_leaf(std::uint32_t node, std::uint64_t first) {
    const std::uint32_t count = leaf_triangles(memory_.words[1][node]);
    ++summary_.leaves;
    summary_.listed += count;
    if (count == 0 && (!rules_.raw || rules_.empty_leaf_hangs)) throw input_error(node_place(), "a leaf of 0 triangles", "at least 1");
    if (rules_.raw) return;
    if (first + count > end_)
      throw input_error(node_place(), fmt::format("its list has the words {} to {}", first, first + count - 1),
                        fmt::format("words below {}, where the stack begins", end_));
    for (std::uint64_t at = first; at < first + count; ++at)
      if (const std::uint32_t triangle = list_triangle(memory_.words[3][at]); triangle >= memory_.triangles.size())
        throw input_error(node_place(), fmt::format("word {} of its list is triangle {}", at, triangle),
                          fmt::format("one of the {} triangles", memory_.triangles.size()));
  }

  void leave(const visit& at) {
    extent& e = extents_[at.node];
    seen_[at.node] = done;
    if (at.children == 0) {
      e.levels = 1;
      e.cycles = std::uint64_t{1} + std::max(leaf_triangles(memory_.words[1][at.node]), 1u);
      return;
    }
    const extent& left = extents_[at.left];
    const extent& right = extents_[at.left + 1];
    e.levels = std::max(left.levels, right.levels) + 1;
    e.cycles = capped_sum(capped_sum(left.cycles, right.cycles), 4);  // NODE, INNER, PUSH, POP
    const unsigned axis = node_axis(memory_.words[0][at.node]);
    for (unsigned signs = 0; signs < 8; ++signs) {
      const bool down = signs >> axis & 1;
      const unsigned near = (down ? right : left).stack_entries[signs], far = (down ? left : right).stack_entries[signs];
      e.stack_entries[signs] = static_cast<std::uint8_t>(std::min(std::max(near + 1, far), 255u));
    }
  }

  // Names the node whose push is one too many, on the way of a ray that needs the most.
  [[noreturn]] void refuse_depth() {
    const auto& needs = extents_[0].stack_entries;
    const auto signs = static_cast<unsigned>(std::max_element(needs.begin(), needs.end()) - needs.begin());
    std::uint32_t node = 0;
    for (unsigned pushed = 0;;) {
      path_.push_back({node});
      const unsigned axis = node_axis(memory_.words[0][node]);
      const auto left = static_cast<std::uint32_t>(node_pointer(memory_.words[0][node]));
      const std::uint32_t down = signs >> axis & 1, near = left + down, far = left + 1 - down;
      const bool to_near = extents_[near].stack_entries[signs] + 1 >= extents_[node].stack_entries[signs];
      if (to_near && ++pushed > most_bih_stack_entries)
        throw input_error(node_place(), fmt::format("a ray may push {} entries on its way here", pushed),
                          fmt::format("at most {}, what the stack holds", most_bih_stack_entries));
      node = to_near ? near : far;
    }
  }

  std::string node_place() const {
    std::string way;
    constexpr std::size_t shown = 6;  // at either end
    for (std::size_t i = 0; i < path_.size(); ++i) {
      if (path_.size() > 2 * shown && i == shown) {
        way += " ...";
        i = path_.size() - shown;
      }
      way += fmt::format("{}{}", i == 0 ? "" : " ", path_[i].node);
    }
    return fmt::format("{}: node {} (from the root: {})", place_, path_.back().node, way);
  }

  const bih_memory& memory_;
  const std::string& place_;
  const bih_rules& rules_;
  const std::uint32_t end_;
  std::vector<extent> extents_;
  std::vector<std::uint8_t> seen_;
  std::vector<visit> path_;
  bih_summary summary_;
};

}  // namespace

bih_memory read_bih(const fs::path& folder, unsigned address_bits, const quantisation& widths) {
  RTU_CHECK(address_bits, >=, least_bih_address_bits);
  RTU_CHECK(address_bits, <=, most_bih_address_bits);
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
    throw input_error(folder.string(), fs::exists(folder, ignored) ? "a file" : "no such folder", "a folder with bih0.txt to bih3.txt");
  bih_memory memory(address_bits);
  for (unsigned w = 0; w < 4; ++w) {
    word_file file(folder, fmt::format("bih{}", w));
    file.open();
    file.expect_lines(memory.words[w].size(), fmt::format("one for each of {} address bits (bih_core.address_bits)", address_bits));
    for (std::uint64_t& word : memory.words[w]) {
      file.next_line();
      word = file.word(file.split_into(1).front());
    }
  }
  word_file box(folder, "scene_aabb");
  box.open();
  box.expect_lines(3, "x, y, z of the scene's upper corner");
  for (std::int64_t& c : memory.corner) {
    box.next_line();
    c = box.value(box.split_into(1).front(), "corner", {widths.n, false});
  }
  word_file list(folder, "tri_ram");
  if (!list.exists()) return memory;
  const word_range coordinate{widths.n, false}, distance{widths.n + 3, true}, factor{widths.m, true};
  const word_range ranges[] = {coordinate, coordinate, distance, factor, factor, factor, factor, factor, factor};
  list.open();
  memory.triangles.reserve(list.lines());
  while (list.next_line()) {
    const auto words = list.split_into(triangle_fields);
    accelerated_triangle& t = memory.triangles.emplace_back();
    for (unsigned f = 0; f + 1 < triangle_fields; ++f) *fields_of(t, f) = list.value(words[f], field_names[f], ranges[f]);
    t.r = static_cast<std::uint8_t>(list.value(words.back(), field_names[triangle_fields - 1], {2, false}));
  }
  return memory;
}

void write_bih(const fs::path& folder, const bih_memory& memory) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw input_error(folder.string(), error.message(), "a folder to write to");
  for (unsigned w = 0; w < 4; ++w) {
    std::string text;
    for (const std::uint64_t word : memory.words[w]) text += fmt::format("{:09x}\n", word);
    write_lines(folder / fmt::format("bih{}.txt", w), text);
  }
  write_lines(folder / "scene_aabb.txt", fmt::format("{:08x}\n{:08x}\n{:08x}\n", memory.corner[0], memory.corner[1], memory.corner[2]));
  std::string text;
  for (accelerated_triangle t : memory.triangles) {
    for (unsigned f = 0; f + 1 < triangle_fields; ++f)
      text += fmt::format("{:09x} ", static_cast<std::uint64_t>(*fields_of(t, f)) & greatest_bih_word);
    text += fmt::format("{:09x}\n", t.r);
  }
  write_lines(folder / "tri_ram.txt", text);
}

bih_summary check_bih(const bih_memory& memory, const std::string& place, const bih_rules& rules) {
  return checker(memory, place, rules).check();
}

}  // namespace rtusim
