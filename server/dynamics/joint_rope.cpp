// Ropes as rigid rows. n runs from B's anchor to A's, so u < 0 stretches and lambda >= 0 pulls the anchors together.
#include "dynamics/joint_rope.h"

#include <algorithm>
#include <cmath>

namespace tumble {

bool make_rope_row(const Rope& rope, const SolverBody& A, const SolverBody& B, double h, const BoundSettings& settings,
                   ScalarRow& row) {
  const Vec3 reach = A.x + row.rA - B.x - row.rB;
  const double distance = std::sqrt(reach.squaredNorm());
  if (!(distance > 0.0)) return false;
  row.n = reach / distance;
  row.gap = rope.length - distance;
  row.lower = 0.0;
  const double u0 = row.n.dot(relative_start_velocity(A, B, row.rA, row.rB));
  const double u1 = row.n.dot(relative_velocity(A, B, row.rA, row.rB));
  if (row.gap + h * std::min(u0, u1) > 0.0) return false;
  row.bound = row.gap > 0.0 ? -row.gap / h
                            : std::min(settings.push_speed,
                                       settings.push_fraction * std::max(0.0, -row.gap - settings.slop) / h);
  return true;
}

}  // namespace tumble
