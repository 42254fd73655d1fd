// The course's solver: one contact at a time, in order, several passes. Step 1 closing velocity, step 2 change of
// velocity for a unit impulse, step 3 the fraction f of it that gives v_s = -C_r v_c. Closing velocity that one step of
// acceleration produced is not given back (microcollision). Friction with the same unit impulse along the sliding
// direction, at most mu times the normal one. Overlap is resolved afterwards by moving and turning both bodies by their
// shares of the unit impulse's effect. No impulse is remembered between steps or taken back within one.
#include <algorithm>
#include <cmath>

#include "dynamics/impact.h"
#include "dynamics/solver.h"

namespace tumble {
namespace {

void apply(SolverBody& A, SolverBody& B, const UnitImpulse& unit, double f) {
  A.v += f * unit.dv_A;
  A.w += f * unit.dw_A;
  B.v += f * unit.dv_B;
  B.w += f * unit.dw_B;
}

void apply_friction(ContactProblem& problem, PointContact& c, double normal) {
  SolverBody &A = problem.bodies[c.a], &B = problem.bodies[c.b];
  const Vec3 u = relative_velocity(A, B, c.rA, c.rB);
  const double u1 = c.t1.dot(u), u2 = c.t2.dot(u), speed = std::sqrt(u1 * u1 + u2 * u2);
  if (speed == 0.0) return;
  const Vec3 direction = -(u1 * c.t1 + u2 * c.t2) / speed;
  const UnitImpulse unit = unit_impulse(A, B, direction, c.rA, c.rB);
  const double f = std::min(speed / unit.ds, c.friction * normal);
  apply(A, B, unit, f);
  c.lambda += f * Vec3(0.0, c.t1.dot(direction), c.t2.dot(direction));
}

/// Returns the change of velocity [m/s].
double resolve_contact(ContactProblem& problem, PointContact& c, double acceleration_share) {
  SolverBody &A = problem.bodies[c.a], &B = problem.bodies[c.b];
  const double u_n = c.n.dot(relative_velocity(A, B, c.rA, c.rB));
  const double free_closing = std::min(c.bound, 0.0);  // a gap may close within the step, not be crossed
  if (u_n >= free_closing) return 0.0;
  const double separating = c.restitution * std::max(0.0, -u_n - acceleration_share);
  const double v_s = std::max(separating, free_closing);
  const UnitImpulse unit = unit_impulse(A, B, c.n, c.rA, c.rB);
  const double f = (v_s - u_n) / unit.ds;
  apply(A, B, unit, f);
  c.lambda.x() += f;
  apply_friction(problem, c, f);
  return v_s - u_n;
}

double resolve_row(ContactProblem& problem, ScalarRow& row) {
  SolverBody &A = problem.bodies[row.a], &B = problem.bodies[row.b];
  const double u = row.n.dot(relative_velocity(A, B, row.rA, row.rB));
  const UnitImpulse unit = unit_impulse(A, B, row.n, row.rA, row.rB);
  const double f = row.is_soft()
                       ? -(row.lambda + row.softness * (u + row.bias)) / (1.0 + row.softness * unit.ds)
                       : std::max(row.is_two_sided() ? row.lower : 0.0, (row.bound - u) / unit.ds);
  apply(A, B, unit, f);
  row.lambda += f;
  return std::abs(f) * unit.ds;
}

/// Interpenetration: `bound` x h is the overlap to remove in this step; what other contacts have already moved counts.
void resolve_overlap(ContactProblem& problem, const PointContact& c) {
  SolverBody &A = problem.bodies[c.a], &B = problem.bodies[c.b];
  const double moved = c.n.dot(B.shift + B.turn.cross(c.rB) - A.shift - A.turn.cross(c.rA));
  const double missing = c.bound * problem.h - moved;
  if (missing <= 0.0) return;
  const UnitImpulse unit = unit_impulse(A, B, c.n, c.rA, c.rB);
  const double f = missing / unit.ds;
  A.shift += f * unit.dv_A;
  A.turn += f * unit.dw_A;
  B.shift += f * unit.dv_B;
  B.turn += f * unit.dw_B;
}

/// Closing velocity of each contact that one step of acceleration produced, >= 0 [m/s].
std::vector<double> acceleration_shares(const ContactProblem& problem) {
  std::vector<double> shares;
  shares.reserve(problem.contacts.size());
  for (const PointContact& c : problem.contacts) {
    const double u_n = c.n.dot(relative_velocity(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB));
    shares.push_back(std::max(0.0, c.un0 - u_n));
  }
  return shares;
}

}  // namespace

SolverReport solve_course_impulse(ContactProblem& problem, const SolverSettings& settings) {
  SolverReport report;
  const std::vector<double> shares = acceleration_shares(problem);
  for (PointContact& c : problem.contacts) c.lambda.setZero();
  for (ScalarRow& row : problem.rows) row.lambda = 0.0;

  double change = settings.tolerance;
  for (; report.sweeps < settings.max_sweeps && change >= settings.tolerance; ++report.sweeps) {
    change = 0.0;
    for (ScalarRow& row : problem.rows) {
      if (row.mass > 0.0) change = std::max(change, resolve_row(problem, row));
    }
    for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
      if (problem.contacts[i].mass_n > 0.0) {
        change = std::max(change, resolve_contact(problem, problem.contacts[i], shares[i]));
      }
    }
  }
  for (int pass = 0; pass < report.sweeps; ++pass) {
    for (const PointContact& c : problem.contacts) {
      if (c.bound > 0.0 && c.mass_n > 0.0) resolve_overlap(problem, c);
    }
  }
  report.residual = compute_residual(problem);
  problem.drift = ContactProblem::Drift::end;
  return report;
}

}  // namespace tumble
