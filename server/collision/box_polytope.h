// A box as a polytope, made on the spot.
#pragma once

#include <array>

#include "collision/polytope.h"
#include "collision/shape.h"

namespace tumble {

/// Face 2i looks along +axis i, face 2i + 1 along -axis i. Corner i lies on the positive side of axis k if bit k is set.
class BoxPolytope : public Polytope {
 public:
  explicit BoxPolytope(const Box& box);
  BoxPolytope(const BoxPolytope&) = delete;  // it views itself
  BoxPolytope& operator=(const BoxPolytope&) = delete;

 private:
  std::array<Vec3, 8> own_vertices_;
  std::array<Side, 24> own_sides_;
  std::array<Face, 6> own_faces_;
  std::array<FourVectors, 2> own_vertex_fours_;
  std::array<FourFaces, 2> own_face_fours_;
};

}  // namespace tumble
