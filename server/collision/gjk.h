// libccd's GJK as a decider between apart and not, certified. The only file pair that knows libccd.
// libccd's own normals, depths and positions are never used: they are wrong-sided, NaN or endless in known cases. Its
// "apart" is believed only when the last search direction, seen by our support callback, really separates.
#pragma once

#include "collision/shape.h"

namespace tumble {

struct GjkAnswer {
  enum class Kind {
    apart,      ///< Proven: `axis_A` separates with `gap` > 0.
    touching,   ///< libccd says they intersect, or too close to tell.
    undecided,  ///< "Apart" without proof, or the call budget was spent: the exact features decide.
  };
  Kind kind;
  Vec3 axis_A;  ///< Unit, from A to B, in A's frame; the best direction seen, also when not apart.
  double gap;   ///< Separation along axis_A by true supports, less its rounding error [m].
  bool budget_hit = false;
};

/// Support-function calls after which libccd is made to stop (each of its loops ends on a degenerate point). Its
/// longest honest run on well-posed pairs was 24.
inline constexpr int kGjkCallBudget = 200;

/// Decides for two convex shapes (no half-space) with B at X_AB, in A's frame, scaled to unit size.
GjkAnswer decide_apart(const Shape& a, const Shape& b, const Pose& X_AB);

}  // namespace tumble
