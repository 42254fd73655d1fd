// Faces of two boxes that look at each other -> contact points: as clip.h, for rectangles. The reference face's sides are
// x = +-h1, y = +-h2 in its own frame, and the names of all points are known beforehand.
#pragma once

#include "collision/box_axis.h"
#include "collision/manifold.h"

namespace tumble {

/// The face of a box that looks along d most: across axis k, on the side `sign`. Corners of a box are numbered by the
/// signs of their coordinates: bit k is set on the positive side of axis k.
struct BoxFace {
  int k;
  double sign, cosine;

  static BoxFace towards(const Vec3& d);
  /// Half of the narrower side of the face [m].
  double width(const Vec3& h) const { return std::min(h[(k + 1) % 3], h[(k + 2) % 3]); }
};

/// Clips B's face against A's or the other way round, whichever `reference_is_a` says, along the axis.
Manifold clip_faces(const BoxPair& pair, const BoxAxis& axis, const BoxFace& face_a, const BoxFace& face_b,
                    bool reference_is_a, double margin);

/// Whether both faces look along the contact normal up to 0.01 rad.
bool lie_face_to_face(const BoxFace& face_a, const BoxFace& face_b);

}  // namespace tumble
