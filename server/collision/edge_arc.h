// The arcs that the normals at edges span on the Gauss sphere: edges of two convex bodies make a facet of their Minkowski
// difference where their arcs cross (Gregorius, The Separating Axis Test between Convex Polyhedra, GDC 2013).
#pragma once

#include <array>

#include "collision/polytope.h"
#include "math/four.h"

namespace tumble {

/// Of B with its normals turned round. All in A's frame.
struct EdgeArc {
  Vec3 tail, along, left, right;
  std::uint32_t index;
  /// Some direction between the two normals.
  Vec3 middle() const { return outward_from_edge(along, left, right); }
};

/// Edges of each body that are looked at together.
inline constexpr std::size_t kArcBlock = 128;
using ArcBlock = std::array<EdgeArc, kArcBlock>;

/// Four arcs of a block, lane by lane; after the last one arcs without length, which cross none.
struct FourArcs {
  FourVectors along, left, right;

  /// Whether the ends of each arc lie on different sides of the other's plane.
  FourFlags straddle(const EdgeArc& arc) const {
    return (dot(left, arc.along) * dot(right, arc.along) < four(0.0)) &
           (dot(along, arc.left) * dot(along, arc.right) < four(0.0));
  }
};
using FourArcBlock = std::array<FourArcs, kArcBlock / 4>;

inline void put_in_fours(const ArcBlock& block, std::size_t count, FourArcBlock& fours) {
  for (std::size_t i = 0; i < count; ++i) {
    FourArcs& arcs = fours[i / 4];
    if (i % 4 == 0) arcs = FourArcs();
    arcs.along.set(i % 4, block[i].along);
    arcs.left.set(i % 4, block[i].left);
    arcs.right.set(i % 4, block[i].right);
  }
}

}  // namespace tumble
