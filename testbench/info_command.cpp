#include "testbench/info_command.h"

#include <fmt/format.h>

#include "modules/formats/svo_image.h"
#include "scenes/mesh.h"
#include "testbench/scene.h"

namespace rtusim {

std::string info_text(const std::filesystem::path& file) {
  if (is_octree(file)) {
    // The widest address and the deepest stack: a file is described even if the usual design can't hold it.
    const svo_limits limits{30, 20};
    const svo_image image = read_svo(file, limits);
    const svo_summary s = describe(image, file.string(), limits);
    return fmt::format(
        "octree of {} levels: {} voxels an edge\n"
        "{:>12} bytes\n{:>12} nodes\n{:>12} far words\n{:>12} leaves\n{:>12} voxels filled ({:.3f} % of the cube)\n",
        s.levels, std::uint64_t{1} << s.levels, s.bytes, s.nodes, s.far_words, s.leaves, s.filled_voxels, 100 * s.filled_share);
  }
  const mesh m = read_mesh(file);
  const bounding_box box = bounds(m);
  return fmt::format(
      "mesh\n{:>12} vertices\n{:>12} triangles\nx {:>12.6g} to {:.6g}\ny {:>12.6g} to {:.6g}\nz {:>12.6g} to {:.6g}\n",
      m.vertices.size(), m.triangles.size(), box.lower.x, box.upper.x, box.lower.y, box.upper.y, box.lower.z, box.upper.z);
}

}  // namespace rtusim
