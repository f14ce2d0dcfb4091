#pragma once

#include <string>

#include "scenes/meshes/mesh.h"

/// Sound model files, made where they are needed.
namespace rtusim::fuzz {

/// A ring of eight corners around and as many across it: closed, of triangles that all differ.
mesh torus();

/// `format`: ascii, binary_little_endian or binary_big_endian.
std::string ply(const mesh& m, const std::string& format);
/// With the words that stand in an OBJ besides.
std::string obj(const mesh& m);
std::string text_stl(const mesh& m);
std::string binary_stl(const mesh& m);
/// Two instances of the mesh; the buffer is a data URI, or in the binary chunk.
std::string gltf(const mesh& m);
std::string glb(const mesh& m);
/// Three Bezier patches.
std::string bpt();

std::string zipped(const std::string& bytes);

}  // namespace rtusim::fuzz
