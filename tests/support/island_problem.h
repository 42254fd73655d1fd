// Contact problems written down directly, without a world: bodies of unit boxes and the contacts between their faces.
#pragma once

#include <cmath>
#include <random>

#include "support/problem_builder.h"

namespace tumble::test {

/// A body at x whose velocity after one step of gravity from rest is v*. Mass 0: immovable.
inline std::uint32_t add_body(ContactProblem& problem, double mass, const Vec3& inertia, const Vec3& x) {
  problem.bodies.push_back(mass > 0.0 ? moving_body(mass, inertia, x) : fixed_body(x));
  if (mass > 0.0) problem.bodies.back().v = problem.h * kGravity;
  return static_cast<std::uint32_t>(problem.bodies.size() - 1);
}

inline std::uint32_t add_cube(ContactProblem& problem, double mass, const Vec3& x) {
  return add_body(problem, mass, Vec3::Constant(mass / 6.0), x);
}

inline std::uint32_t add_sphere(ContactProblem& problem, double mass, double radius, const Vec3& x) {
  return add_body(problem, mass, Vec3::Constant(0.4 * mass * radius * radius), x);
}

/// Contact at p (in W) with normal n from a to b.
inline void add_contact(ContactProblem& problem, std::uint32_t a, std::uint32_t b, const Vec3& p,
                        const Vec3& n, double friction, double separation = 0.0) {
  problem.contacts.push_back(contact_at(problem, a, b, p, n, separation, friction));
}

/// The four corners of the horizontal overlap of two unit cubes, b on top of a (or of the ground).
inline void add_face_contact(ContactProblem& problem, std::uint32_t a, std::uint32_t b, double friction) {
  const SolverBody &A = problem.bodies[a], &B = problem.bodies[b];
  const auto range = [&](int axis) {
    const double half = A.inv_mass > 0.0 ? 0.5 : 1e3;
    return std::pair(std::max(A.x[axis] - half, B.x[axis] - 0.5),
                     std::min(A.x[axis] + half, B.x[axis] + 0.5));
  };
  const auto [x0, x1] = range(0);
  const auto [y0, y1] = range(1);
  const double z = B.x.z() - 0.5;
  for (const double x : {x0, x1}) {
    for (const double y : {y0, y1}) add_contact(problem, a, b, Vec3(x, y, z), Vec3::UnitZ(), friction);
  }
}

inline void prepare_rigid(ContactProblem& problem) {
  prepare(problem, kNoSlop);
}

/// `count` unit cubes of 1 kg on each other with offsets of +-1 cm, the top one of another mass; body 0 is the ground.
inline ContactProblem stack_problem(int count, double top_mass = 1.0, double h = 1.0 / 60.0,
                                    double friction = 0.5) {
  ContactProblem problem;
  problem.h = h;
  add_cube(problem, 0.0, Vec3(0, 0, -0.5));
  for (int i = 0; i < count; ++i) {
    const double offset = i % 2 == 0 ? 0.01 : -0.01;
    const std::uint32_t box =
        add_cube(problem, i + 1 == count ? top_mass : 1.0, Vec3(offset, -0.5 * offset, 0.5 + i));
    add_face_contact(problem, box - 1, box, friction);
  }
  prepare_rigid(problem);
  return problem;
}

/// A wall of unit cubes, `base` of them in the lowest row, each row one shorter and half a cube shifted.
inline ContactProblem pyramid_problem(int base, double h = 1.0 / 60.0, double friction = 0.5) {
  ContactProblem problem;
  problem.h = h;
  add_cube(problem, 0.0, Vec3(0, 0, -0.5));
  std::vector<std::uint32_t> below;
  for (int row = 0; row < base; ++row) {
    std::vector<std::uint32_t> boxes;
    for (int i = 0; i + row < base; ++i) {
      const std::uint32_t box = add_cube(problem, 1.0, Vec3(1.0 * i + 0.5 * row, 0, 0.5 + row));
      boxes.push_back(box);
      if (row == 0) {
        add_face_contact(problem, 0, box, friction);
      } else {
        add_face_contact(problem, below[static_cast<std::size_t>(i)], box, friction);
        add_face_contact(problem, below[static_cast<std::size_t>(i) + 1], box, friction);
      }
    }
    below = boxes;
  }
  prepare_rigid(problem);
  return problem;
}

/// Spheres of random mass, place and velocity with contacts at random points and normals of a random graph: solvable
/// (bounds <= 0), frictional, of no particular shape.
inline ContactProblem random_problem(std::uint32_t seed, int bodies, int contacts) {
  std::mt19937 generator(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(generator()) / 4294967296.0);
  };
  const auto vector = [&](double size) {
    const double x = uniform(-size, size), y = uniform(-size, size), z = uniform(-size, size);
    return Vec3(x, y, z);
  };
  ContactProblem problem;
  problem.h = 0.01;
  add_cube(problem, 0.0, Vec3::Zero());
  for (int i = 0; i < bodies; ++i) {
    const double mass = uniform(0.5, 2.0);
    const Vec3 x = vector(1.0);
    SolverBody& body = problem.bodies[add_sphere(problem, mass, 0.5, x)];
    body.v = vector(1.0);
    body.w = vector(1.0);
  }
  for (int i = 0; i < contacts; ++i) {
    const auto b = static_cast<std::uint32_t>(1 + i % bodies);
    auto a = static_cast<std::uint32_t>(generator() % b);
    if (i >= bodies) a = static_cast<std::uint32_t>(generator() % static_cast<std::uint32_t>(bodies + 1));
    if (a == b) a = 0;
    const Vec3 n = vector(1.0).normalized();
    // The point is half a radius from b's centre against n, on average.
    const Vec3 p = problem.bodies[b].x - 0.5 * n + vector(0.2);
    const double friction = uniform(0.1, 1.0);
    add_contact(problem, a, b, p, n, friction, uniform(0.0, 2e-3));
  }
  prepare_rigid(problem);
  return problem;
}

/// Total normal impulse between two bodies [N s].
inline double normal_impulse(const ContactProblem& problem, std::uint32_t a, std::uint32_t b) {
  double sum = 0.0;
  for (const PointContact& c : problem.contacts) {
    if (c.a == a && c.b == b) sum += c.lambda.x();
  }
  return sum;
}

}  // namespace tumble::test
