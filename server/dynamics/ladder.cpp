// See ladder.h.
#include "dynamics/ladder.h"

#include <algorithm>
#include <cmath>

#include "dynamics/alm_newton.h"
#include "dynamics/cone_newton.h"
#include "dynamics/interior_point.h"

namespace tumble {
namespace {

/// Solutions are sought a tenth below the tolerance or rounding, so that they are accepted as warm starts of the steps
/// that follow.
constexpr double kMargin = 0.1;
constexpr std::size_t kFewContacts = 8;
/// Of the speeds, and of 1 m/s: residuals below which no rung gets reliably; a single body's sweeps get to the last digit.
constexpr double kLadderRounding = 1e-11, kRoundingOfSmall = 1e-15;

double largest_impulse(const ContactProblem& problem) {
  double largest = 0.0;
  for (const PointContact& c : problem.contacts) largest = std::max(largest, c.lambda.x());
  for (const ScalarRow& row : problem.rows) {
    if (!row.is_soft()) largest = std::max(largest, std::abs(row.lambda));
  }
  return largest;
}

}  // namespace

Ladder::Ladder(ContactProblem& problem, const SolverSettings& settings)
    : problem_(problem), settings_(settings), best_(problem) {
  report_.accepted = best_.residual() < settings.tolerance;
  best_.restore_start();
  for (const SolverBody& body : problem.bodies) {
    if (body.inv_mass == 0.0) continue;
    ++movable_;
    const double mass = 1.0 / body.inv_mass;
    mass_ += mass;
    lightest_ = std::min(lightest_, mass);
    heaviest_ = std::max(heaviest_, mass);
    speed_ = std::max(speed_, std::sqrt(body.v.squaredNorm()));
  }
  for (const PointContact& c : problem.contacts) {
    const Vec3 u = relative_velocity(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB);
    speed_ = std::max(speed_, std::sqrt(u.squaredNorm()));
  }
  rounding_ = (is_small() ? kRoundingOfSmall : kLadderRounding) * (1.0 + speed_);
  wanted_ = kMargin * std::max(settings.tolerance, rounding_);
}

bool Ladder::is_small() const {
  return movable_ == 1 && problem_.contacts.size() <= kFewContacts;
}

double Ladder::start_speed() const {
  double square = 0.0;
  for (const SolverBody& body : problem_.bodies) {
    if (body.inv_mass > 0.0) square = std::max({square, body.v0.squaredNorm(), body.w0.squaredNorm()});
  }
  return std::sqrt(square);
}

bool Ladder::fits(std::uint64_t limit) {
  pattern_ = VelocitySystem::find_pattern(problem_, limit);
  return pattern_ != nullptr;
}

VelocitySystem& Ladder::system() {
  if (!pattern_) fits(BlockPattern::kNoLimit);
  if (!system_) system_.emplace(problem_, pattern_);
  return *system_;
}

void Ladder::sweep(int max_sweeps) {
  SolverSettings limited = settings_;
  limited.max_sweeps = max_sweeps;
  limited.tolerance = wanted_;
  best_.restore_start();
  report_.sweeps += solve_pgs(problem_, limited).sweeps;
  best_.offer();
}

void Ladder::newton(int max_iterations) {
  report_.newton_steps += run_alm_newton(problem_, system(), wanted_, max_iterations, best_);
}

void Ladder::cone_newton(int max_iterations) {
  report_.newton_steps += run_cone_newton(problem_, system(), wanted_, max_iterations, best_);
}

bool Ladder::interior_point(double residual) {
  report_.iterations += run_interior_point(problem_, system(), residual, best_);
  return best_.residual() < residual;
}

/// 1e3 times all momentum is more than any lever gives: bounds that cannot all be kept drive impulses to infinity.
bool Ladder::is_plausible() const {
  const double gravity = std::sqrt(settings_.gravity.squaredNorm());
  return largest_impulse(problem_) <= 1e3 * mass_ * (gravity * problem_.h + speed_);
}

SolverReport Ladder::finish() {
  best_.restore();
  // What has no solution leaves a residual of the size of its bounds, far above these, or impulses without end.
  const bool plausible = is_plausible();
  if (!plausible || !(best_.residual() <= std::max(1e-3, 1e-2 * speed_))) {
    report_.fallback = true;
    report_.accepted = false;
    const BestImpulses found = best_;
    report_.newton_steps += find_compromise(problem_, system(), best_);
    if (plausible && found.residual() < 0.5 * best_.residual()) best_.go_back(found);
    best_.restore();
  }
  report_.work = work() * (report_.newton_steps + report_.iterations);
  report_.residual = best_.residual();
  report_.exact = true;
  problem_.drift = choose_drift(problem_);
  return report_;
}

void Ladder::leave() {
  best_.restore_start();
}

}  // namespace tumble
