// Islands whose joints and ropes pull hard, in parts of a step. What a taut joint holds by an arm r swings about it like a
// pendulum, with omega^2 = r . f (1/I) of a link (geometric stiffness); arms that are fixed within a step make the motion an
// explicit midpoint rule, which gains energy without bound once h omega > 2, and the energy pulls harder still. The parts
// are short enough for what the joints pull in them. World frame.
#include <algorithm>
#include <cmath>

#include "world/world.h"

namespace tumble {
namespace {

/// [rad] of the swing, or turn, in a part: as many parts as keep to it, and again if it turned out to be twice as much. A
/// pass of joint_step.cpp leaves a quarter of the square of it; with a radian chains at 60 Hz gain energy (tests/stability).
constexpr double kPhase = 0.5, kMostPhase = 1.0;
constexpr double kTautRounding = 1e-9;  // of a rest that is meant to be a whole number of parts

/// k tr(I^-1 (r.n - r n^T)): what a pull of n at r adds to the sum of the squares of the swings [1/s^2].
double swing_square(const SolverBody& body, const Vec3& r, const Vec3& n) {
  return r.dot(n) * body.inv_I_W.trace() - n.dot(body.inv_I_W * r);
}

}  // namespace

/// Phase [rad] by which the fastest swing of a body of the solved problem goes on in its step, or by which the body turns.
double World::swing_phase() {
  const ContactProblem& problem = scratch_.problem;
  std::vector<double>& square = scratch_.swing_square;
  square.assign(problem.bodies.size(), 0.0);
  for (const ScalarRow& row : problem.rows) {
    if (row.is_soft()) continue;
    square[row.a] -= row.lambda * swing_square(problem.bodies[row.a], row.rA, row.n);
    square[row.b] += row.lambda * swing_square(problem.bodies[row.b], row.rB, row.n);
  }
  double phase_square = 0.0;
  for (const double s : square)
    phase_square = std::max(phase_square, problem.h * s);  // forces are impulses over h
  for (const ScalarRow& row : problem.rows) {
    if (row.is_soft()) continue;
    for (const std::uint32_t i : {row.a, row.b})
      phase_square = std::max(phase_square, problem.h * problem.h * problem.bodies[i].w.squaredNorm());
  }
  return std::sqrt(phase_square);
}

bool World::is_taut() {
  return options_.taut_parts > 1 && solves_exactly(options_.solver) && !scratch_.problem.rows.empty() &&
         swing_phase() > kPhase;
}

/// The problem of a part of the step that begins where the parts before it ended; `opened` says by how much the gaps
/// of the contacts have changed since the step began [m].
void World::solve_taut_part(std::size_t island, const StepContext& part) {
  build_part(island, part);
  ContactProblem& problem = scratch_.problem;
  for (std::size_t i = 0; i < problem.contacts.size(); ++i)
    problem.contacts[i].separation += scratch_.opened[i];
  prepare(problem, part.bounds);
  solve_problem(part);
}

void World::note_opening() {
  const ContactProblem& problem = scratch_.problem;
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const PointContact& c = problem.contacts[i];
    const SolverBody &A = problem.bodies[c.a], &B = problem.bodies[c.b];
    const Vec3 moved = B.shift + B.turn.cross(c.rB) - A.shift - A.turn.cross(c.rA);
    scratch_.opened[i] += problem.h * drift_speed(problem, c) + c.n.dot(moved);
  }
}

void World::advance_taut(std::size_t island, const StepContext& step) {
  const double shortest = step.h / options_.taut_parts;
  scratch_.opened.assign(scratch_.problem.contacts.size(), 0.0);
  StepContext rest = step;
  double wanted = step.h * kPhase / swing_phase();
  while (rest.h > 0.0) {
    StepContext part = rest;
    const double parts = std::ceil(rest.h / std::max(wanted, shortest) - kTautRounding);
    part.h = rest.h / std::max(1.0, parts);
    solve_taut_part(island, part);
    const double phase = swing_phase();
    wanted = part.h * kPhase / phase;
    if (phase > kMostPhase && part.h > (1.0 + kTautRounding) * shortest) continue;
    if (try_rest(scratch_.residual)) return;
    ++counters_.taut_parts;
    note_opening();
    move_bodies(part);
    hold_joints(island, part);
    rest.begin += part.h;
    rest.h = parts > 1.0 ? rest.h - part.h : 0.0;
  }
}

}  // namespace tumble
