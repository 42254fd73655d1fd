// Slides that end within a step. Friction jumps where a slide ends: an island that takes it for one mean force over the
// whole step is wrong by terms of h^2. Here the step of the island is cut at that moment, found by solving for the part
// of the step up to it: while all slide, velocities run linearly, so the second or third part is exact. World frame.
#include <algorithm>
#include <cmath>
#include <optional>

#include "world/world.h"

namespace tumble {
namespace {

/// [m/s] what is slower has stopped (solvers leave as much); slides up to ten times faster end with the step: 1e-9 m.
constexpr double kStopped = 1e-8, kSlow = 1e-7;
/// [m] or [m/step] by which a contact may be open or opening and still have been pressed all the way.
constexpr double kPressed = 1e-6;
/// Share of the friction limit that is not all of it.
constexpr double kShare = 1e-6;
constexpr int kMostTrials = 12;

Vec3 tangential(const Vec3& u, const PointContact& c) {
  return u - u.dot(c.n) * c.n;
}

Vec3 start_slide(const ContactProblem& problem, const PointContact& c) {
  return tangential(relative_start_velocity(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB), c);
}

/// Speed along the direction at the start [m/s].
double remaining_slide(const ContactProblem& problem, const PointContact& c) {
  const Vec3 start = start_slide(problem, c);
  const Vec3 u = relative_velocity(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB);
  return u.dot(start) / std::sqrt(start.squaredNorm());
}

double friction_share(const PointContact& c) {
  return std::sqrt(c.lambda.y() * c.lambda.y() + c.lambda.z() * c.lambda.z()) / (c.friction * c.lambda.x());
}

/// Pressed throughout, slid at the start, sticks at the end.
bool ends_slide(const ContactProblem& problem, const PointContact& c) {
  if (!(c.friction > 0.0 && c.lambda.x() > 0.0) || std::abs(c.separation) > kPressed ||
      std::abs(c.un0) * problem.h > kPressed)
    return false;
  const double start = std::sqrt(start_slide(problem, c).squaredNorm());
  if (start < kSlow) return false;
  const Vec3 end = tangential(relative_velocity(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB), c);
  return std::sqrt(end.squaredNorm()) < kStopped && friction_share(c) < 1.0 - kShare;
}

}  // namespace

bool World::may_end_slides(const StepContext& step) const {
  return scratch_.problem.drift == ContactProblem::Drift::average && may_be_cut(step, options_.slide_bodies);
}

/// Leaves the island solved up to that moment. None, and solved for anything: it was not found before the end.
std::optional<double> World::find_end_of_slide(std::size_t island, const StepContext& rest,
                                               const std::vector<std::size_t>& ending, double guess) {
  const ContactProblem& problem = scratch_.problem;
  StepContext part = rest;
  part.h = guess;
  for (int trial = 0; trial < kMostTrials; ++trial, part.h *= 0.5) {
    solve_part(island, part);
    double end = kInfinity;
    bool all_slide = true;
    for (const std::size_t i : ending) {
      const PointContact& c = problem.contacts[i];
      const double start = std::sqrt(start_slide(problem, c).squaredNorm());
      const double left = remaining_slide(problem, c);
      all_slide = all_slide && left > kStopped;
      if (left < start) end = std::min(end, part.h * start / (start - left));
    }
    if (!all_slide) continue;
    part.h = end;
    if (!(end < rest.h)) return std::nullopt;
    solve_part(island, part);
    if (problem.drift != ContactProblem::Drift::average) return std::nullopt;
    return end;
  }
  return std::nullopt;
}

bool World::advance_slide(std::size_t island, StepContext& rest) {
  if (!may_end_slides(rest)) return false;
  const ContactProblem& problem = scratch_.problem;
  std::vector<std::size_t> ending;
  double share = 1.0;
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    if (!ends_slide(problem, problem.contacts[i])) continue;
    ending.push_back(i);
    share = std::min(share, friction_share(problem.contacts[i]));
  }
  if (ending.empty()) return false;
  const std::optional<double> end = find_end_of_slide(island, rest, ending, 0.5 * share * rest.h);
  if (!end) {
    solve_part(island, rest);
    return false;
  }
  ++counters_.slides_ended;
  std::vector<Touch> touches = note_touches(rest);
  for (const std::size_t i : ending) touches[i].sticks = true;
  const std::vector<PointContact> first = problem.contacts;
  StepContext part = rest;
  part.h = *end;
  move_bodies(part);
  update_island_contacts(island, part);
  hold_touches(island, touches, part);
  rest.h -= *end;
  rest.begin += *end;
  solve_part(island, rest);
  // The longer part knows the pressure with more digits.
  if (part.h > rest.h && first.size() == problem.contacts.size()) {
    for (std::size_t i = 0; i < first.size(); ++i)
      scratch_.problem.contacts[i].lambda.x() = rest.h / part.h * first[i].lambda.x();
    store_impulses();
  }
  return true;
}

}  // namespace tumble
