// The contact problem to rounding: the warm start if it is good, sweeps for a single body, else the interior point and
// a polish; the best impulses found are the result. What has no solution (a body wedged between walls that overlap it)
// is recognised by its residual or its impulses and left to soft_step, whose push is bounded.
#include <algorithm>
#include <cmath>

#include "dynamics/best_impulses.h"
#include "dynamics/interior_point.h"
#include "dynamics/solver.h"

namespace tumble {
namespace {

/// Solutions are sought a tenth below the tolerance, so that they are accepted as warm starts of the steps that follow.
constexpr double kMargin = 0.1;
constexpr int kPolishSweeps = 10;
/// A single body with up to two faces' contacts: 30 sweeps cost less than one factorization.
constexpr std::size_t kFewContacts = 8;

/// How much motion and impulse there is in the problem before it is solved.
struct Extent {
  double mass = 0.0;   // [kg] of the movable bodies
  double speed = 0.0;  // [m/s] fastest approach at a contact or row
  int movable = 0;
};

Extent measure(const ContactProblem& problem) {
  Extent extent;
  for (const SolverBody& body : problem.bodies) {
    if (body.inv_mass == 0.0) continue;
    ++extent.movable;
    extent.mass += 1.0 / body.inv_mass;
    extent.speed = std::max(extent.speed, std::sqrt(body.v.squaredNorm()));
  }
  for (const PointContact& c : problem.contacts) {
    const Vec3 u = relative_velocity(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB);
    extent.speed = std::max(extent.speed, std::sqrt(u.squaredNorm()));
  }
  return extent;
}

double largest_impulse(const ContactProblem& problem) {
  double largest = 0.0;
  for (const PointContact& c : problem.contacts) largest = std::max(largest, c.lambda.x());
  for (const ScalarRow& row : problem.rows) {
    if (!row.is_soft()) largest = std::max(largest, std::abs(row.lambda));
  }
  return largest;
}

/// Bounds that cannot all be kept drive impulses to infinity and leave a residual of their own size. 1e-3 m/s and 1e-2
/// of the speeds are far above what any solvable problem left; 1e3 times all momentum is more than any lever gives.
bool is_trustworthy(const ContactProblem& problem, const Extent& extent, const SolverSettings& settings,
                    double residual) {
  const double gravity = std::sqrt(settings.gravity.squaredNorm());
  return residual <= std::max(1e-3, 1e-2 * extent.speed) &&
         largest_impulse(problem) <= 1e3 * extent.mass * (gravity * problem.h + extent.speed);
}

int sweep(ContactProblem& problem, const SolverSettings& settings, int max_sweeps, BestImpulses& best) {
  SolverSettings limited = settings;
  limited.max_sweeps = max_sweeps;
  limited.tolerance = kMargin * settings.tolerance;
  best.restore_start();
  const int sweeps = solve_pgs(problem, limited).sweeps;
  best.offer();
  return sweeps;
}

}  // namespace

SolverReport solve_exact(ContactProblem& problem, const SolverSettings& settings) {
  const Extent extent = measure(problem);
  BestImpulses best(problem);
  SolverReport report;
  report.accepted = best.residual() < settings.tolerance;
  if (!report.accepted) {
    const double wanted = kMargin * settings.tolerance;
    if (extent.movable == 1 && problem.contacts.size() <= kFewContacts) {
      report.sweeps += sweep(problem, settings, settings.max_sweeps, best);
    }
    if (best.residual() >= wanted) report.iterations = solve_interior_point(problem, wanted, best).iterations;
    if (best.residual() >= wanted) report.sweeps += sweep(problem, settings, kPolishSweeps, best);
  }
  best.restore();
  report.residual = best.residual();
  if (!is_trustworthy(problem, extent, settings, report.residual)) {
    best.drop();
    report.fallback = true;
    report.accepted = false;
    const SolverReport soft = solve_soft_step(problem, settings);
    report.sweeps += soft.sweeps;
    report.residual = soft.residual;
    return report;
  }
  problem.drift = choose_drift(problem);
  return report;
}

}  // namespace tumble
