// Random boxes that strike the ground with 1, 3 or 4 points at once, friction and restitution random for each point: what
// the worst of the outcomes does to energy, cone, approach and momentum.
#pragma once

#include <algorithm>

#include "dynamics/reflection.h"
#include "support/problem_builder.h"

namespace tumble::test {

struct BlowTally {
  double gain = 0.0;         ///< Of kinetic energy, relative to that before.
  double beyond_cone = 0.0;  ///< |p_t| - mu p_n, relative to p_n; and pulling impulses.
  double approach = 0.0;     ///< Left at a point, relative to the fastest before.
  double momentum = 0.0;     ///< Not accounted for by the impulses, relative.
  int capped = 0, clamped = 0, slid = 0;
};

inline BlowTally strike_random_boxes(int points, int count, const ReflectionSettings& settings = {}) {
  BlowTally tally;
  std::uint64_t state = 12345 + static_cast<std::uint64_t>(points);
  const auto random = [&state] {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<double>(state >> 11) * 0x1p-53;
  };
  const auto random_vector = [&random] {
    const double x = random(), y = random(), z = random();
    return Vec3(2.0 * x - 1.0, 2.0 * y - 1.0, 2.0 * z - 1.0);
  };
  for (int trial = 0; trial < count; ++trial) {
    ContactProblem problem;
    problem.h = 1.0;
    const Vec3 half = 0.05 * Vec3::Ones() + 0.5 * random_vector().cwiseAbs();
    const double mass = 0.1 + 5.0 * random();
    const Vec3 squares = half.cwiseProduct(half);
    const Vec3 moments = mass / 3.0 * (Vec3::Constant(squares.sum()) - squares);
    const Mat3 R = rotation_matrix(exp_map(3.0 * random_vector()));
    SolverBody box = moving_body(mass, moments, Vec3::Zero());
    box.inv_I_W = R * Mat3(moments.cwiseInverse().asDiagonal()) * R.transpose();
    box.v = random_vector() - Vec3(0, 0, 1);
    box.w = 3.0 * random_vector();
    problem.bodies = {fixed_body(), box};
    // Corners of one side of the box, seen from the ground: they need not be level for a blow.
    const double sides[4][2] = {{-1, -1}, {1, 1}, {-1, 1}, {1, -1}};
    for (int i = 0; i < points; ++i) {
      const Vec3 corner = R * Vec3(sides[i][0] * half.x(), sides[i][1] * half.y(), -half.z());
      const double friction = 1.2 * random(), restitution = random();
      problem.contacts.push_back(
          contact_at(problem, 0, 1, corner, Vec3::UnitZ(), 0.0, friction, restitution));
    }
    prepare(problem, kNoSlop);
    double speed = 0.0;
    for (const PointContact& c : problem.contacts) {
      speed = std::max(speed, relative_velocity(problem.bodies[0], problem.bodies[1], c.rA, c.rB).norm());
    }
    const double before = kinetic_energy(problem);
    const Vec3 v_before = box.v;
    const ReflectionReport report = reflect(problem, settings);
    tally.capped += report.capped;
    tally.clamped += report.clamped;
    tally.gain = std::max(tally.gain, kinetic_energy(problem) / before - 1.0);
    Vec3 sum = Vec3::Zero();
    for (const PointContact& c : problem.contacts) {
      const double p_t = std::sqrt(c.lambda.y() * c.lambda.y() + c.lambda.z() * c.lambda.z());
      const double limit = c.friction * c.lambda.x();
      if (c.lambda.x() != 0.0) {
        tally.beyond_cone = std::max(tally.beyond_cone, (p_t - limit) / std::abs(c.lambda.x()));
        tally.slid += p_t > 0.99 * limit;
      }
      const Vec3 u = relative_velocity(problem.bodies[0], problem.bodies[1], c.rA, c.rB);
      tally.approach = std::max(tally.approach, -u.z() / speed);
      sum += c.lambda.x() * c.n + c.lambda.y() * c.t1 + c.lambda.z() * c.t2;
    }
    const double error = (problem.bodies[1].v - v_before - sum / mass).norm();
    tally.momentum = std::max(tally.momentum, error / speed);
  }
  return tally;
}

}  // namespace tumble::test
