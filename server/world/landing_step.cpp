// Contacts without restitution that close within a step. A step that closes them at its end moves them for all of it as
// if they never met: wrong by terms of h. Here the step of a small island is cut where the first one closes: its way up to
// there is that without the open contacts, the time is where the narrow phase sees no gap, and there the points that
// touch strike, inelastic and with friction (reflection.h). World frame.
#include <algorithm>
#include <cmath>

#include "dynamics/reflection.h"
#include "dynamics/time_of_impact.h"
#include "world/world.h"

namespace tumble {
namespace {

/// [m] gap at the time found.
constexpr double kMet = 1e-11;
/// [m/s] slower ones close with the step: what they are wrong by is no more than this times its length.
constexpr double kSlowest = 1e-3;
/// [s] before the end of the step: there they close with it, and are as right.
constexpr double kEndOfStep = 1e-9;
constexpr int kMostLooks = 8;

}  // namespace

bool World::advance_landing(std::size_t island, StepContext& rest) {
  const ContactProblem& problem = scratch_.problem;
  if (!may_be_cut(rest, options_.landing_bodies)) return false;
  if (std::none_of(problem.contacts.begin(), problem.contacts.end(),
                   [&](const PointContact& c) { return is_open(c, rest) && c.lambda.x() > 0.0; }))
    return false;
  IslandState& start = scratch_.landing_start;
  note_island(island, start);
  StepContext part = rest;
  part.airborne = true;
  solve_part(island, part);
  double speed = 0.0, gap = kInfinity;
  part.h = find_landing(start.problem, rest, speed);
  for (int trial = 0; trial < kMostLooks && speed > kSlowest && part.h < rest.h - kEndOfStep; ++trial) {
    solve_part(island, part);
    const double whole = part.h;
    const std::vector<Touch> held = note_touches(part);
    const Advance advance = advance_until_cut(island, part, true);
    if (advance == Advance::part) {  // a slide ends before
      rest.h -= whole - part.h;
      rest.begin = part.begin;
      solve_part(island, rest);
      return true;
    }
    if (advance == Advance::none) {
      move_bodies(part);
      update_island_contacts(island, part);
    }
    gap = landing_gap(island, held);
    if (std::abs(gap) <= kMet) break;
    const double later = part.h + gap / speed;
    restore_island(island, start);
    part.h = std::clamp(later, 0.5 * part.h, 0.5 * (part.h + rest.h));
  }
  if (!(std::abs(gap) <= kMet)) {
    restore_island(island, start);
    return false;
  }
  ++counters_.landings;
  land_island(island, part);
  rest.h -= part.h;
  rest.begin += part.h;
  solve_part(island, rest);
  return true;
}

/// When the first of the open contacts at the start closes, on the way that was solved without them, and how fast then.
double World::find_landing(const ContactProblem& start, const StepContext& rest, double& speed) const {
  const ContactProblem& airborne = scratch_.problem;
  double first = kInfinity;
  for (const PointContact& c : start.contacts) {
    if (!is_open(c, rest)) continue;
    const SolverBody &A = airborne.bodies[c.a], &B = airborne.bodies[c.b];
    const double u = c.n.dot(relative_start_velocity(A, B, c.rA, c.rB));
    const double a = (c.n.dot(relative_velocity(A, B, c.rA, c.rB)) - u) / rest.h;
    const double time = time_above(c.separation, u, a);
    if (time >= first) continue;
    first = time;
    speed = -(u + a * time);
  }
  return first;
}

/// Of the points that nothing held in this part [m].
double World::landing_gap(std::size_t island, const std::vector<Touch>& held) {
  double least = kInfinity;
  for (const std::uint32_t index : contacts_of_island(island)) {
    const Manifold& manifold = contacts_[index].manifold;
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(manifold.count); ++i) {
      if (find_touch(held, {index, i}) == nullptr) least = std::min(least, manifold.points[i].separation);
    }
  }
  return least;
}

/// The law of Coulomb and Moreau for all points that touch at once: what small steps tend to. It takes energy, always.
void World::land_island(std::size_t island, const StepContext& part) {
  build_instant_problem(island, part);
  ContactProblem& problem = scratch_.problem;
  leave_out_open_contacts(part);
  for (PointContact& c : problem.contacts) {
    c.separation = 0.0;
    c.restitution = 0.0;
    c.lambda.setZero();
  }
  prepare(problem, part.bounds);
  if (!solve(part, kSharp).exact) reflect(problem);
  store_blow();
}

}  // namespace tumble
