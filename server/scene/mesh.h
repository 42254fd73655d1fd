// Triangle meshes from files, Wavefront OBJ or STL (ASCII and binary): what surfaces and convex hulls are built from.
#pragma once

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "math/types.h"

namespace tumble {

/// what(): "FILE:LINE: reason (value)", for binary files "FILE: reason (value)".
class MeshError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The file that a mesh uri means: a path (relative to `directory` unless absolute), with or without file://.
/// Throws MeshError for other schemes.
std::string resolve_mesh_path(const std::string& uri, const std::string& directory);

struct MeshTriangles {
  std::vector<Vec3>
      vertices;  ///< In the file's order and unit (taken as [m]), repeated where the file repeats them.
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< Polygons of OBJ as fans about their first corner.
};

/// Every vertex is read, whether a face uses it or not. Throws MeshError.
MeshTriangles read_mesh_file(const std::string& path);

/// The same from bytes in memory; `name` stands for the file in messages.
MeshTriangles read_obj(std::string_view text, const std::string& name);
MeshTriangles read_stl(std::string_view bytes, const std::string& name);

/// Each distinct point once, in order.
std::vector<Vec3> distinct_points(const std::vector<Vec3>& points);

}  // namespace tumble
