// See box_polytope.h. The topology is that of every box.
#include "collision/box_polytope.h"

#include <algorithm>

namespace tumble {
namespace {

constexpr std::array<std::uint32_t, 24> kBoxLoops = {1, 3, 7, 5, 0, 4, 6, 2, 2, 6, 7, 3,
                                                     0, 1, 5, 4, 4, 5, 7, 6, 0, 2, 3, 1};
constexpr std::array<std::uint32_t, 9> kBoxNeighbourOffsets = {0, 3, 6, 9, 12, 15, 18, 21, 24};

constexpr std::array<std::uint32_t, 24> box_neighbours() {
  std::array<std::uint32_t, 24> neighbours{};
  for (std::uint32_t i = 0; i < 24; ++i) neighbours[i] = (i / 3) ^ (1u << i % 3);
  return neighbours;
}

/// The corner that follows in the loop of a face.
constexpr std::uint32_t box_loop_after(std::uint32_t i) {
  return kBoxLoops[i % 4 == 3 ? i - 3 : i + 1];
}

/// The face whose loop runs from one corner to the other.
constexpr std::uint32_t box_face_left_of(std::uint32_t tail, std::uint32_t head) {
  std::uint32_t i = 0;
  while (kBoxLoops[i] != tail || box_loop_after(i) != head) ++i;
  return i / 4;
}

/// The face beyond each side of each face: its plane is the plane of the side.
constexpr std::array<std::uint32_t, 24> box_faces_beyond() {
  std::array<std::uint32_t, 24> beyond{};
  for (std::uint32_t i = 0; i < 24; ++i) beyond[i] = box_face_left_of(box_loop_after(i), kBoxLoops[i]);
  return beyond;
}

constexpr std::array<Polytope::Edge, 12> box_edges() {
  std::array<Polytope::Edge, 12> edges{};
  std::size_t n = 0;
  for (std::uint32_t i = 0; i < 24; ++i) {
    const std::uint32_t tail = kBoxLoops[i], head = box_loop_after(i);
    if (tail < head) edges[n++] = {tail, head, i / 4, box_face_left_of(head, tail)};
  }
  return edges;
}

/// The edge from corner i / 3 across axis i % 3.
constexpr std::array<std::uint32_t, 24> box_edges_around() {
  std::array<std::uint32_t, 24> around{};
  const auto edges = box_edges();
  for (std::uint32_t i = 0; i < 24; ++i) {
    const std::uint32_t corner = i / 3, other = corner ^ (1u << i % 3);
    while (edges[around[i]].tail != std::min(corner, other) ||
           edges[around[i]].head != std::max(corner, other)) {
      ++around[i];
    }
  }
  return around;
}

constexpr std::array<std::uint32_t, 24> kBoxNeighbours = box_neighbours(),
                                        kBoxEdgesAround = box_edges_around(),
                                        kBoxFacesBeyond = box_faces_beyond();
constexpr std::array<Polytope::Edge, 12> kBoxEdges = box_edges();

}  // namespace

BoxPolytope::BoxPolytope(const Box& box) {
  const Vec3& h = box.half_extents;
  for (std::uint32_t i = 0; i < 8; ++i) {
    for (int k = 0; k < 3; ++k) own_vertices_[i][k] = i >> k & 1 ? h[k] : -h[k];
  }
  for (std::uint32_t i = 0; i < 6; ++i) {
    const int axis = static_cast<int>(i / 2);
    const double h1 = h[(axis + 1) % 3], h2 = h[(axis + 2) % 3];
    own_faces_[i] = {i % 2 ? Vec3(-Vec3::Unit(axis)) : Vec3::Unit(axis), h[axis], 4 * i, 4,
                     2.0 * h1 * h2 / (h1 + h2)};
  }
  for (std::uint32_t i = 0; i < 24; ++i) {
    const Face& beyond = own_faces_[kBoxFacesBeyond[i]];
    own_sides_[i] = {beyond.normal, beyond.offset};
  }
  put_in_fours(own_vertices_, own_vertex_fours_.data());
  put_in_fours(own_faces_, own_face_fours_.data());
  static_cast<Polytope&>(*this) = {
      own_vertices_,  kBoxLoops,       own_sides_,        own_faces_,      kBoxEdges,    kBoxNeighbourOffsets,
      kBoxNeighbours, kBoxEdgesAround, own_vertex_fours_, own_face_fours_, Vec3::Zero(), h.norm()};
}

}  // namespace tumble
