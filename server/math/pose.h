// A rigid transform X_AB: maps points of frame B into frame A. Letters cancel: X_AC = X_AB * X_BC.
#pragma once

#include "math/types.h"

namespace tumble {

struct Pose {
  Quat q = Quat::Identity();  ///< q_AB, unit.
  Vec3 p = Vec3::Zero();      ///< p_AB, origin of B in A [m].

  Vec3 operator*(const Vec3& p_B) const { return q * p_B + p; }
  Pose operator*(const Pose& X_BC) const { return {q * X_BC.q, q * X_BC.p + p}; }
  Pose inverse() const {
    const Quat qi = q.conjugate();
    return {qi, -(qi * p)};
  }
};

}  // namespace tumble
