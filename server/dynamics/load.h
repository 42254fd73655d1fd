// What acts on one body through a step besides contacts: forces and torques constant in W, constant in the body, and
// constant in W at points that move with the body. The last two follow the body as it turns. Lever arms from the centre
// of mass.
#pragma once

#include "math/rotation.h"

namespace tumble {

class Load {
 public:
  void add_world_force(const Vec3& force_W, const Vec3& point_B) {
    force_W_ += force_W;
    lever_ += point_B * force_W.transpose();
  }
  void add_world_torque(const Vec3& torque_W) { torque_W_ += torque_W; }
  void add_body_force(const Vec3& force_B, const Vec3& point_B) {
    force_B_ += force_B;
    torque_B_ += point_B.cross(force_B);
  }
  void add_body_torque(const Vec3& torque_B) { torque_B_ += torque_B; }

  /// Some part turns with the body; if not, force() and torque() are the same at every orientation.
  bool follows_body() const { return !(force_B_.isZero(0.0) && torque_B_.isZero(0.0) && lever_.isZero(0.0)); }

  const Vec3& force_W() const { return force_W_; }
  const Vec3& torque_W() const { return torque_W_; }

  /// [N], [N m], in W at the orientation whose matrix is R_WB.
  Vec3 force(const Mat3& R_WB) const { return force_W_ + R_WB * force_B_; }
  Vec3 torque(const Mat3& R_WB) const {
    const Mat3 H = R_WB * lever_;  // sum of r F^T; its antisymmetric part is the sum of r x F
    return torque_W_ + R_WB * torque_B_ + Vec3(H(1, 2) - H(2, 1), H(2, 0) - H(0, 2), H(0, 1) - H(1, 0));
  }

 private:
  Vec3 force_W_ = Vec3::Zero(), torque_W_ = Vec3::Zero();
  Vec3 force_B_ = Vec3::Zero(), torque_B_ = Vec3::Zero();
  Mat3 lever_ = Mat3::Zero();
};

}  // namespace tumble
