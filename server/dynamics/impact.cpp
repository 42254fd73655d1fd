// Restitution as a sequence of single-contact impacts, the hardest closing first, ties by index. Each conserves momentum
// and does not raise kinetic energy, hence neither does any sequence of them. Works on the velocities at the start of
// the step; the velocities after forces get the same changes.
#include "dynamics/impact.h"

#include <algorithm>
#include <cmath>

#include "dynamics/point_impact.h"

namespace tumble {
namespace {

/// A contact that may bounce, with what does not change during the impacts.
struct Candidate {
  std::size_t contact;
  double force_speed;  ///< Closing speed that one step of forces produces [m/s], >= 0.
  double closing;      ///< -u_n at the start of the step if it is to bounce now, else 0 [m/s].
};

double closing_speed(const ContactProblem& problem, const Candidate& candidate, double threshold) {
  const PointContact& c = problem.contacts[candidate.contact];
  const SolverBody &A = problem.bodies[c.a], &B = problem.bodies[c.b];
  const double closing = -c.n.dot(relative_start_velocity(A, B, c.rA, c.rB));
  if (!(closing > threshold + candidate.force_speed)) return 0.0;
  const double u_end = c.n.dot(relative_velocity(A, B, c.rA, c.rB));
  const bool closes = c.separation <= 0.0 || c.separation + problem.h * u_end < 0.0;
  return closes ? closing : 0.0;
}

std::vector<Candidate> find_candidates(const ContactProblem& problem, double threshold) {
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const PointContact& c = problem.contacts[i];
    if (c.restitution <= 0.0 || c.mass_n == 0.0) continue;
    const SolverBody &A = problem.bodies[c.a], &B = problem.bodies[c.b];
    const double u0 = c.n.dot(relative_start_velocity(A, B, c.rA, c.rB));
    const double u1 = c.n.dot(relative_velocity(A, B, c.rA, c.rB));
    candidates.push_back({i, std::max(0.0, u0 - u1), 0.0});
    candidates.back().closing = closing_speed(problem, candidates.back(), threshold);
  }
  return candidates;
}

void apply_impact(SolverBody& body, const Vec3& r, const Vec3& impulse) {
  const Vec3 dv = body.inv_mass * impulse, dw = body.inv_I_W * r.cross(impulse);
  body.v0 += dv;
  body.w0 += dw;
  body.v += dv;
  body.w += dw;
}

void bounce(ContactProblem& problem, const PointContact& c) {
  SolverBody &A = problem.bodies[c.a], &B = problem.bodies[c.b];
  const Vec3 u_W = relative_start_velocity(A, B, c.rA, c.rB);
  Mat3 frame;
  frame << c.n, c.t1, c.t2;
  Vec3 impulse;
  if (c.friction > 0.0) {
    const Mat3 K = inverse_mass(A, B, c);
    impulse = frame * solve_point_impact(K, frame.transpose() * u_W, c.friction, c.restitution);
  } else {
    const UnitImpulse unit = unit_impulse(A, B, c.n, c.rA, c.rB);
    impulse = impulse_fraction(c.n.dot(u_W), c.restitution, unit.ds) * c.n;
  }
  apply_impact(A, c.rA, -impulse);
  apply_impact(B, c.rB, impulse);
}

}  // namespace

ImpactReport resolve_impacts(ContactProblem& problem, const ImpactSettings& settings) {
  ImpactReport report;
  std::vector<Candidate> candidates = find_candidates(problem, settings.threshold_speed);
  const std::uint64_t limit = static_cast<std::uint64_t>(settings.max_impacts) * problem.contacts.size();
  while (true) {
    const auto hardest =
        std::max_element(candidates.begin(), candidates.end(),
                         [](const Candidate& a, const Candidate& b) { return a.closing < b.closing; });
    if (hardest == candidates.end() || hardest->closing == 0.0) break;
    if (report.impacts == limit) {
      report.capped = true;
      break;
    }
    const PointContact& struck = problem.contacts[hardest->contact];
    bounce(problem, struck);
    ++report.impacts;
    for (Candidate& candidate : candidates) {
      const PointContact& c = problem.contacts[candidate.contact];
      if (c.a == struck.a || c.a == struck.b || c.b == struck.a || c.b == struck.b) {
        candidate.closing = closing_speed(problem, candidate, settings.threshold_speed);
      }
    }
  }
  if (report.impacts > 0) {
    for (PointContact& c : problem.contacts) {
      c.un0 = c.n.dot(relative_start_velocity(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB));
    }
  }
  return report;
}

UnitImpulse unit_impulse(const SolverBody& A, const SolverBody& B, const Vec3& n, const Vec3& rA,
                         const Vec3& rB) {
  UnitImpulse unit;
  unit.dv_A = -A.inv_mass * n;
  unit.dw_A = -(A.inv_I_W * rA.cross(n));
  unit.dv_B = B.inv_mass * n;
  unit.dw_B = B.inv_I_W * rB.cross(n);
  unit.ds = n.dot(unit.dv_B + unit.dw_B.cross(rB)) - n.dot(unit.dv_A + unit.dw_A.cross(rA));
  return unit;
}

double impulse_fraction(double u_n, double restitution, double ds) {
  return -(1.0 + restitution) * u_n / ds;
}

}  // namespace tumble
