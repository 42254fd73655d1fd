// A triangle as a polytope, made on the spot.
#pragma once

#include <array>

#include "collision/polytope.h"

namespace tumble {

/// Corners counter-clockwise about the unit normal; a body without thickness: face 0 looks along the normal.
class TrianglePolytope : public Polytope {
 public:
  TrianglePolytope(const std::array<Vec3, 3>& corners, const Vec3& normal);
  TrianglePolytope(const TrianglePolytope&) = delete;  // it views itself
  TrianglePolytope& operator=(const TrianglePolytope&) = delete;

 private:
  std::array<Vec3, 3> own_vertices_;
  std::array<Side, 6> own_sides_;
  std::array<Face, 2> own_faces_;
  FourVectors own_vertex_four_;
  FourFaces own_face_four_;
};

}  // namespace tumble
