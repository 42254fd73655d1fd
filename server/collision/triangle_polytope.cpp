// See triangle_polytope.h.
#include "collision/triangle_polytope.h"

#include <algorithm>

namespace tumble {
namespace {

constexpr std::array<std::uint32_t, 6> kTriangleLoops = {0, 1, 2, 0, 2, 1};
constexpr std::array<Polytope::Edge, 3> kTriangleEdges = {{{0, 1, 0, 1}, {1, 2, 0, 1}, {0, 2, 1, 0}}};
constexpr std::array<std::uint32_t, 4> kTriangleNeighbourOffsets = {0, 2, 4, 6};
constexpr std::array<std::uint32_t, 6> kTriangleNeighbours = {1, 2, 0, 2, 0, 1},
                                       kTriangleEdgesAround = {0, 2, 0, 1, 2, 1};

}  // namespace

TrianglePolytope::TrianglePolytope(const std::array<Vec3, 3>& corners, const Vec3& normal)
    : own_vertices_(corners) {
  const Vec3 u = corners[1] - corners[0], v = corners[2] - corners[0];
  const double width = u.cross(v).norm() / (u.norm() + v.norm() + (v - u).norm());
  const double offset = normal.dot(corners[0]);
  own_faces_ = {{{normal, offset, 0, 3, width}, {-normal, -offset, 3, 3, width}}};
  for (std::size_t i = 0; i < 6; ++i) {
    const std::size_t next = i % 3 == 2 ? i - 2 : i + 1;
    own_sides_[i] =
        make_side(own_faces_[i / 3].normal, corners[kTriangleLoops[i]], corners[kTriangleLoops[next]]);
  }
  put_in_fours(own_vertices_, &own_vertex_four_);
  put_in_fours(own_faces_, &own_face_four_);
  static_cast<Polytope&>(*this) = {own_vertices_,
                                   kTriangleLoops,
                                   own_sides_,
                                   own_faces_,
                                   kTriangleEdges,
                                   kTriangleNeighbourOffsets,
                                   kTriangleNeighbours,
                                   kTriangleEdgesAround,
                                   {&own_vertex_four_, 1},
                                   {&own_face_four_, 1},
                                   (corners[0] + corners[1] + corners[2]) / 3.0,
                                   std::max({corners[0].norm(), corners[1].norm(), corners[2].norm()})};
}

}  // namespace tumble
