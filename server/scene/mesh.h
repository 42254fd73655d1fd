// Points of a triangle mesh from a file, Wavefront OBJ or STL (ASCII and binary): what a convex hull is built from.
#pragma once

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

/// All vertices of the file, in its order and unit (taken as [m]); each distinct point once. Every vertex is read,
/// whether a face uses it or not. Throws MeshError.
std::vector<Vec3> read_mesh_points(const std::string& path);

/// The same from bytes in memory; `name` stands for the file in messages.
std::vector<Vec3> read_obj_points(std::string_view text, const std::string& name);
std::vector<Vec3> read_stl_points(std::string_view bytes, const std::string& name);

}  // namespace tumble
