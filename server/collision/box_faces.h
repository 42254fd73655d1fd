// Faces of two boxes that look at each other -> contact points: as clip.h, for rectangles. The reference face's sides are
// x = +-h1, y = +-h2 in its own frame, and the names of all points are known beforehand.
#pragma once

#include "collision/box_axis.h"
#include "collision/manifold_builder.h"

namespace tumble {

/// The face of a box that looks along d most: across axis k, on the side `sign`. Corners of a box are numbered by the
/// signs of their coordinates: bit k is set on the positive side of axis k.
struct BoxFace {
  int k;
  double sign, cosine;

  static BoxFace towards(const Vec3& d);
  /// Half of the narrower side of the face [m].
  double width(const Vec3& h) const { return std::min(h[next_axis(k)], h[next_axis(next_axis(k))]); }
};

/// The faces of A and B that look at each other along an axis.
struct FacingFaces {
  FacingFaces(const BoxPair& pair, const BoxAxis& axis);
  /// The same ones, seen along another direction: unit, from A to B.
  void see_along(const BoxPair& pair, const Vec3& normal_A);
  /// Whether both look along the contact normal up to 0.01 rad.
  bool lie_face_to_face() const { return std::min(a.cosine, b.cosine) > ContactTolerance::kFaceToFace; }

  BoxFace a, b;
  Vec3 normal_A;     ///< Of the contact, unit, from A to B.
  Vec3 towards_a_B;  ///< The same in B, from B to A.
};

/// Clips B's face against A's or the other way round, whichever `reference_is_a` says, along their normal. `separation` is
/// that of the boxes along it [m].
Manifold clip_faces(const BoxPair& pair, const FacingFaces& faces, double separation, bool reference_is_a,
                    double margin);

}  // namespace tumble
