// Springs as soft rows. Implicit midpoint rule: force of the spring's length and rate at the middle of the step,
//   lambda = -h [k (C_m - rest) + c (u0 + u)/2],   length at the middle C_m = C + h (u0 + u)/4,
// which is lambda = -s (u + bias) with s = h (h k/4 + c/2) and bias = u0 + h k (C - rest)/s. n runs from A's anchor to
// B's, lambda acts + on B: a stretched spring has lambda < 0. Direction and arms are taken where free motion would have
// the anchors at half the step; the spring's own part of that motion is along n, so the force is central at the true
// midpoint, and bodies that move with the average velocity keep their angular momentum to round-off.
#include "dynamics/force_spring.h"

#include <cmath>

#include "math/rotation.h"

namespace tumble {

double spring_tension(const Spring& spring, double length, double length_rate) {
  return spring.stiffness * (length - spring.rest_length) + spring.damping * length_rate;
}

void soften_row(ScalarRow& row, double h, double extension, double start_speed, ContactProblem::Drift drift) {
  const bool midpoint = drift == ContactProblem::Drift::average;
  const double before = midpoint ? 0.25 : 0.0,
               after = 0.5 - before;  // weights of h u0 and h u in the extension
  row.softness = h * (after * h * row.stiffness + 0.5 * row.damping);
  const double known =
      h * row.stiffness * (extension + before * h * start_speed) + 0.5 * h * row.damping * start_speed;
  row.bias = known / row.softness;
}

bool make_spring_row(const Spring& spring, const SolverBody& A, const SolverBody& B, double h,
                     ScalarRow& row) {
  if (spring.stiffness == 0.0 && spring.damping == 0.0) return false;
  const Vec3 start = B.x + row.rB - A.x - row.rA;
  const Vec3 rate = relative_start_velocity(A, B, row.rA, row.rB) + relative_velocity(A, B, row.rA, row.rB);
  const Vec3 middle = start + 0.25 * h * rate;
  const double length = std::sqrt(middle.squaredNorm());
  if (!(length > 0.0)) return false;
  row.n = middle / length;
  row.rA += 0.25 * h * (A.w0 + A.w).cross(row.rA);
  row.rB += 0.25 * h * (B.w0 + B.w).cross(row.rB);
  row.stiffness = spring.stiffness;
  row.damping = spring.damping;
  // C is chosen such that C + h (u0 + u*)/4 is the length at the predicted midpoint exactly.
  const double u0 = row.n.dot(relative_start_velocity(A, B, row.rA, row.rB));
  const double u1 = row.n.dot(relative_velocity(A, B, row.rA, row.rB));
  row.extension = length - 0.25 * h * (u0 + u1) - spring.rest_length;
  soften_row(row, h, row.extension, u0, ContactProblem::Drift::average);
  return true;
}

double spring_energy(const Spring& spring, double length) {
  const double extension = length - spring.rest_length;
  return 0.5 * spring.stiffness * extension * extension;
}

}  // namespace tumble
