// Joints that hold two bodies together: ball (a point) and fixed (all of them). Each is a set of rigid two-sided rows of
// the island's problem that hold points on lines: three rows in one point for a ball, and for a fixed joint three more in
// points beside it, which leave no turn. A hinge would need two of these; so no joint needs machinery of its own.
#pragma once

#include <array>

#include "dynamics/contact_problem.h"

namespace tumble {

/// A point of A and one of B that have no distance along a direction of A.
struct HeldPoint {
  Vec3 pA = Vec3::Zero(), pB = Vec3::Zero();  ///< From the centres of mass, in body axes [m].
  Vec3 n_A = Vec3::UnitX();                   ///< In A's axes, unit.
};

struct Joint {
  static constexpr std::size_t kMostRows = 6;
  std::array<HeldPoint, kMostRows> held;
  std::size_t rows = 0;
};

/// Holds A's point pA and B's point pB together; all turns are free.
Joint make_ball_joint(const Vec3& pA, const Vec3& pB);
/// Holds B in the pose relative to A in which pA and pB meet and B is turned by q_AB. The points beside them are `arm`
/// [m] > 0 away: where a turn counts like a displacement.
Joint make_fixed_joint(const Vec3& pA, const Vec3& pB, const Quat& q_AB, double arm);

/// One row of a joint now, as a blow meets it: u = 0.
ScalarRow make_joint_row(const HeldPoint& held, std::uint32_t a, std::uint32_t b, const SolverBody& A,
                         const SolverBody& B);

/// One row of a joint over a step h. With the mean of the arms at its start and where the velocities of A and B have them
/// at its end: a body that turns about its joint keeps its distance for bodies that move with the average velocity, and the joint does no work. A gap left by
/// rounding or by the scene closes with gap/h, at most settings.push_speed; not by a velocity
/// if settings.push_fraction is 0: overlap.h closes it.
ScalarRow make_joint_row(const HeldPoint& held, std::uint32_t a, std::uint32_t b, const SolverBody& A,
                         const SolverBody& B, double h, const BoundSettings& settings);

}  // namespace tumble
