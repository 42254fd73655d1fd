// Contact problems by hand, and a pile of unit cubes that steps with any solver: the contact points are the corners of
// the faces' overlap as built, fixed to the upper cube, against the top plane of the lower one. No collision detection,
// so what is measured is the solver alone. World frame, z up.
#pragma once

#include <cmath>
#include <vector>

#include "dynamics/solver.h"
#include "math/rotation.h"
#include "support/gravity.h"

namespace tumble::test {

inline constexpr double kStep = 1.0 / 240.0;  // [s]
inline const Vec3 kGravity(0.0, 0.0, -kG);

inline SolverBody fixed_body(const Vec3& x = Vec3::Zero()) {
  SolverBody body;
  body.x = x;
  return body;
}

/// Principal moments `I` [kg m^2] along W's axes.
inline SolverBody moving_body(double mass, const Vec3& I, const Vec3& x, const Vec3& v = Vec3::Zero(),
                              const Vec3& w = Vec3::Zero()) {
  SolverBody body = fixed_body(x);
  body.inv_mass = 1.0 / mass;
  body.inv_I_W = I.cwiseInverse().asDiagonal();
  body.v = body.v0 = v;
  body.w = body.w0 = w;
  return body;
}

/// A cube of edge 1 m.
inline SolverBody cube(double mass, const Vec3& x, const Vec3& v = Vec3::Zero(),
                       const Vec3& w = Vec3::Zero()) {
  return moving_body(mass, Vec3::Constant(mass / 6.0), x, v, w);
}

inline SolverBody ball(double mass, double radius, const Vec3& x, const Vec3& v = Vec3::Zero(),
                       const Vec3& w = Vec3::Zero()) {
  return moving_body(mass, Vec3::Constant(0.4 * mass * radius * radius), x, v, w);
}

/// v* = v0 + h g for every movable body.
inline void apply_gravity(ContactProblem& problem, const Vec3& g = kGravity) {
  for (SolverBody& body : problem.bodies) {
    if (body.inv_mass > 0.0) body.v += problem.h * g;
  }
}

/// Contact at `point` (middle of the gap, W), n from a to b.
inline PointContact contact_at(const ContactProblem& problem, std::uint32_t a, std::uint32_t b,
                               const Vec3& point, const Vec3& n, double gap, double friction,
                               double restitution = 0.0) {
  PointContact c;
  c.a = a;
  c.b = b;
  c.n = n;
  c.rA = point - problem.bodies[a].x;
  c.rB = point - problem.bodies[b].x;
  c.separation = gap;
  c.friction = friction;
  c.restitution = restitution;
  set_tangents(c);
  return c;
}

inline const BoundSettings kNoSlop{.slop = 0.0, .push_fraction = 0.2, .push_speed = 3.0};

struct Momentum {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();  // about W's origin
  double scale = 0.0;                                  // sum of the magnitudes, for relative comparisons
};

/// Of the movable bodies at (v, w), or at (v0, w0).
inline Momentum momentum(const ContactProblem& problem, bool start = false) {
  Momentum sum;
  for (const SolverBody& body : problem.bodies) {
    if (body.inv_mass == 0.0) continue;
    const Vec3 p = (start ? body.v0 : body.v) / body.inv_mass;
    const Vec3 L = body.inv_I_W.inverse() * (start ? body.w0 : body.w);
    sum.linear += p;
    sum.angular += body.x.cross(p) + L;
    sum.scale += p.norm() * (1.0 + body.x.norm()) + L.norm();
  }
  return sum;
}

inline double kinetic_energy(const ContactProblem& problem, bool start = false) {
  double sum = 0.0;
  for (const SolverBody& body : problem.bodies) {
    if (body.inv_mass == 0.0) continue;
    const Vec3 &v = start ? body.v0 : body.v, &w = start ? body.w0 : body.w;
    sum += 0.5 * v.squaredNorm() / body.inv_mass + 0.5 * w.dot(body.inv_I_W.inverse() * w);
  }
  return sum;
}

/// Moves the bodies over the step as the world does, exact for bodies with equal moments of inertia.
inline void move_bodies(ContactProblem& problem) {
  const bool average = problem.drift == ContactProblem::Drift::average;
  for (SolverBody& body : problem.bodies) {
    const Vec3 v = average ? Vec3(0.5 * (body.v0 + body.v)) : body.v;
    const Vec3 w = average ? Vec3(0.5 * (body.w0 + body.w)) : body.w;
    body.x += problem.h * v + body.shift;
    body.q = normalized(exp_map(body.turn) * (exp_map(problem.h * w) * body.q));
    body.v0 = body.v;
    body.w0 = body.w;
    body.shift.setZero();
    body.turn.setZero();
  }
}

class CubePile {
 public:
  CubePile(double h, double friction) : friction_(friction) {
    problem_.h = h;
    problem_.bodies.push_back(fixed_body(Vec3(0.0, 0.0, -0.5)));  // a floor "cube" of any width
  }

  std::uint32_t add(double mass, const Vec3& x) {
    problem_.bodies.push_back(cube(mass, x));
    return static_cast<std::uint32_t>(problem_.bodies.size() - 1);
  }

  /// `upper` stands on `lower` (0: the floor) with the corners of the overlap of both faces.
  void support(std::uint32_t lower, std::uint32_t upper) {
    const Vec3 d =
        lower == 0 ? Vec3(Vec3::Zero()) : Vec3(problem_.bodies[lower].x - problem_.bodies[upper].x);
    const double x[2] = {std::max(-0.5, d.x() - 0.5), std::min(0.5, d.x() + 0.5)};
    const double y[2] = {std::max(-0.5, d.y() - 0.5), std::min(0.5, d.y() + 0.5)};
    for (int i = 0; i < 4; ++i) points_.push_back({lower, upper, Vec3(x[i & 1], y[i >> 1], -0.5)});
    impulses_.resize(points_.size(), Vec3::Zero());
  }

  SolverReport step(SolveFunction solve, const SolverSettings& settings,
                    const BoundSettings& bounds = kNoSlop) {
    prepare_step(bounds);
    const SolverReport report = solve(problem_, settings);
    for (std::size_t i = 0; i < points_.size(); ++i) impulses_[i] = problem_.contacts[i].lambda;
    move_bodies(problem_);
    return report;
  }

  void prepare_step(const BoundSettings& bounds = kNoSlop) {
    problem_.contacts.clear();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const SolverBody &A = problem_.bodies[points_[i].lower], &B = problem_.bodies[points_[i].upper];
      const Vec3 n = A.q * Vec3::UnitZ();
      const Vec3 p = B.x + B.q * points_[i].p_B;
      const double gap = n.dot(p - A.x) - 0.5;
      PointContact c =
          contact_at(problem_, points_[i].lower, points_[i].upper, p - 0.5 * gap * n, n, gap, friction_);
      c.lambda = impulses_[i];
      problem_.contacts.push_back(c);
    }
    apply_gravity(problem_);
    prepare(problem_, bounds);
  }

  ContactProblem& problem() { return problem_; }
  const SolverBody& body(std::uint32_t i) const { return problem_.bodies[i]; }

 private:
  struct Point {
    std::uint32_t lower, upper;
    Vec3 p_B;
  };
  double friction_;
  ContactProblem problem_;
  std::vector<Point> points_;
  std::vector<Vec3> impulses_;
};

/// Offsets of +-1 cm, alternating, so that nothing is symmetric by luck.
inline CubePile make_stack(int count, double h, double top_mass = 1.0) {
  CubePile pile(h, 0.5);
  for (int i = 0; i < count; ++i) {
    const Vec3 x(i % 2 == 0 ? 0.01 : -0.01, i % 3 == 0 ? 0.01 : -0.01, 0.5 + i);
    const std::uint32_t body = pile.add(i + 1 == count ? top_mass : 1.0, x);
    pile.support(body - 1, body);
  }
  return pile;
}

inline CubePile make_pyramid(int base, double h) {
  CubePile pile(h, 0.5);
  std::vector<std::uint32_t> below;
  for (int row = 0; row < base; ++row) {
    std::vector<std::uint32_t> now;
    for (int i = 0; i < base - row; ++i) {
      const std::uint32_t body = pile.add(1.0, Vec3(1.1 * (i + 0.5 * row), 0.0, 0.5 + row));
      now.push_back(body);
      if (row == 0) {
        pile.support(0, body);
      } else {
        pile.support(below[static_cast<std::size_t>(i)], body);
        pile.support(below[static_cast<std::size_t>(i) + 1], body);
      }
    }
    below = now;
  }
  return pile;
}

}  // namespace tumble::test
