#include "scenes/meshes/orientation.h"

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

namespace rtusim {
namespace {

// Sets of triangles, each with whether it is turned against the first of its set (union by size, paths halved).
class turned_sets {
 public:
  explicit turned_sets(std::size_t members) : members_(members) {
    for (std::uint32_t i = 0; i < members; ++i) members_[i].above = i;
  }

  // The first of the set, and whether `i` is turned against it.
  std::pair<std::uint32_t, bool> find(std::uint32_t i) {
    bool turned = false;
    while (members_[i].above != i) {
      member& m = members_[i];
      const member& up = members_[m.above];
      turned ^= m.turned;
      i = m.above;
      if (up.above == i) continue;
      m = {up.above, m.size, m.turned != up.turned};
    }
    return {i, turned};
  }
  // Makes the sets of two one; if they are one already, it stays as it is.
  void join(std::uint32_t i, std::uint32_t j, bool turned) {
    auto [a, a_turned] = find(i);
    auto [b, b_turned] = find(j);
    if (a == b) return;
    if (members_[a].size < members_[b].size) std::swap(a, b);
    members_[a].size += members_[b].size;
    members_[b].above = a;
    members_[b].turned = turned != (a_turned != b_turned);
  }

 private:
  struct member {
    std::uint32_t above = 0, size = 1;
    bool turned = false;
  };
  std::vector<member> members_;
};

// A triangle at an edge, which is given by its lesser and its greater vertex.
struct side {
  std::uint32_t lesser, greater, triangle;
  bool upwards;  // the triangle runs from the lesser to the greater

  auto edge() const { return std::tie(lesser, greater); }
};

std::vector<side> sides_by_edge(const mesh& m) {
  std::vector<side> sides;
  sides.reserve(3 * m.all_triangles());
  for (std::uint32_t n = 0; n < m.all_triangles(); ++n) {
    const auto& t = m.triangle(n);
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;  // an edge there and back
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), n, a < b});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const side& a, const side& b) { return a.edge() < b.edge(); });
  return sides;
}

turned_sets sets_of(const mesh& m) {
  turned_sets sets(m.all_triangles());
  const std::vector<side> sides = sides_by_edge(m);
  for (std::size_t i = 0, next = 0; i < sides.size(); i = next) {
    while (next < sides.size() && sides[next].edge() == sides[i].edge()) ++next;
    if (next - i == 2) sets.join(sides[i].triangle, sides[i + 1].triangle, sides[i].upwards == sides[i + 1].upwards);
  }
  return sets;
}

}  // namespace

std::uint64_t turn_alike(mesh& m) {
  turned_sets sets = sets_of(m);
  // Of a set, by its first triangle: how many triangles are as it is, and how many are turned against it; six times their volume.
  struct balance {
    std::uint64_t alike = 0, turned = 0;
    double volume = 0;
  };
  std::vector<balance> balances(m.all_triangles());
  const glm::dvec3 origin = bounds(m).centre();
  for (std::uint32_t n = 0; n < m.all_triangles(); ++n) {
    const auto [first, turned] = sets.find(n);
    const auto corner = [&](std::size_t k) { return m.vertices[m.triangle(n)[k]] - origin; };
    const double volume = glm::dot(corner(0), glm::cross(corner(1), corner(2)));
    balance& b = balances[first];
    ++(turned ? b.turned : b.alike);
    b.volume += turned ? -volume : volume;
  }
  std::uint64_t count = 0;
  for (std::uint32_t n = 0; n < m.all_triangles(); ++n) {
    const auto [first, turned] = sets.find(n);
    const balance& b = balances[first];
    const bool right_is_turned = b.turned > b.alike || (b.turned == b.alike && b.volume < 0);
    if (turned == right_is_turned) continue;
    std::swap(m.triangle(n)[1], m.triangle(n)[2]);
    ++count;
  }
  return count;
}

}  // namespace rtusim
