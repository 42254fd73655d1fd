// The contact problem of one island: local masses, velocity bounds, warm start, residual and the choice of drift.
// Formulas: knowledge of the Coulomb problem with velocity bounds, natural-map residual (Acary, Brogliato 2008, ch. 8).
#include "dynamics/contact_problem.h"

#include <algorithm>
#include <cmath>

#include "math/rotation.h"

namespace tumble {
namespace {

/// d . K d of one body: inverse mass and inverse inertia seen along d at the arm r.
double inverse_mass_along(const SolverBody& body, const Vec3& r, const Vec3& d, const Vec3& e) {
  return body.inv_mass * d.dot(e) + r.cross(d).dot(body.inv_I_W * r.cross(e));
}

void update_masses(const std::vector<SolverBody>& bodies, PointContact& c) {
  const SolverBody &A = bodies[c.a], &B = bodies[c.b];
  const auto k = [&](const Vec3& d, const Vec3& e) {
    return inverse_mass_along(A, c.rA, d, e) + inverse_mass_along(B, c.rB, d, e);
  };
  const double k_nn = k(c.n, c.n), k11 = k(c.t1, c.t1), k22 = k(c.t2, c.t2), k12 = k(c.t1, c.t2);
  const double half = 0.5 * (k11 - k22);
  const double largest = 0.5 * (k11 + k22) + std::sqrt(half * half + k12 * k12);
  c.mass_n = k_nn > 0.0 ? 1.0 / k_nn : 0.0;
  c.mass_t = largest > 0.0 ? 1.0 / largest : 0.0;
}

double bound_of(double gap, double h, const BoundSettings& settings) {
  if (gap > 0.0) return -gap / h;
  return std::min(settings.push_speed, settings.push_fraction * std::max(0.0, -gap - settings.slop) / h);
}

/// Without a push. The points of two faces lie in a plane, and so must their gaps: four velocities that no motion of a body
/// has leave the load to creep from one point to the next for ever.
void set_bounds_by_deepest(ContactProblem& problem) {
  const auto end = problem.contacts.end();
  for (auto begin = problem.contacts.begin(); begin != end;) {
    const auto next = std::find_if(begin, end, [&](const PointContact& c) {
      return c.a != begin->a || c.b != begin->b || c.n != begin->n;
    });
    double deepest = 0.0;
    for (auto c = begin; c != next; ++c) deepest = std::min(deepest, c->separation);
    for (; begin != next; ++begin) begin->bound = (deepest - begin->separation) / problem.h;
  }
}

double contact_residual(const ContactProblem& problem, const PointContact& c) {
  if (c.mass_n == 0.0) return 0.0;  // neither body can be moved
  const Vec3 u = relative_velocity(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB);
  const double l_n = c.lambda.x();
  const double r_n = std::abs(std::max(0.0, l_n - c.mass_n * (u.dot(c.n) - c.bound)) - l_n) / c.mass_n;
  const double l1 = c.lambda.y(), l2 = c.lambda.z();
  double y1 = l1 - c.mass_t * u.dot(c.t1), y2 = l2 - c.mass_t * u.dot(c.t2);
  const double radius = c.friction * std::max(0.0, l_n), length = std::sqrt(y1 * y1 + y2 * y2);
  if (length > radius) {
    y1 *= radius / length;
    y2 *= radius / length;
  }
  const double r_t = std::sqrt((y1 - l1) * (y1 - l1) + (y2 - l2) * (y2 - l2)) / c.mass_t;
  return std::max(r_n, r_t) + 0.0 * (u.sum() + c.lambda.sum() + r_n + r_t);
}

void update_masses(const ContactProblem& problem, Turning& turning) {
  const PointContact& c = problem.contacts[turning.contact];
  const Mat3 K = problem.bodies[c.a].inv_I_W + problem.bodies[c.b].inv_I_W;
  const double k_nn = c.n.dot(K * c.n), k11 = c.t1.dot(K * c.t1), k22 = c.t2.dot(K * c.t2);
  const double k12 = c.t1.dot(K * c.t2), half = 0.5 * (k11 - k22);
  const double largest = 0.5 * (k11 + k22) + std::sqrt(half * half + k12 * k12);
  turning.mass_n = k_nn > 0.0 ? 1.0 / k_nn : 0.0;
  turning.mass_t = largest > 0.0 ? 1.0 / largest : 0.0;
}

double turning_residual(const ContactProblem& problem, const Turning& turning) {
  if (turning.mass_n == 0.0) return 0.0;
  const PointContact& c = problem.contacts[turning.contact];
  const Vec3 w = problem.bodies[c.b].w - problem.bodies[c.a].w;
  const Vec3 mass(turning.mass_n, turning.mass_t, turning.mass_t);
  const Vec3 wanted = turning.lambda - mass.cwiseProduct(Vec3(w.dot(c.n), w.dot(c.t1), w.dot(c.t2)));
  const Vec3 change = nearest_moment(turning, wanted, c.lambda.x()) - turning.lambda;
  const double r_t = std::sqrt(change.y() * change.y() + change.z() * change.z()) / turning.mass_t;
  const double r_n = std::abs(change.x()) / turning.mass_n;
  return std::max(r_n, r_t) + 0.0 * (r_n + r_t);
}

double row_residual(const ContactProblem& problem, const ScalarRow& row) {
  if (row.mass == 0.0) return 0.0;
  const double u = row.n.dot(relative_velocity(problem.bodies[row.a], problem.bodies[row.b], row.rA, row.rB));
  const double r =
      row.is_soft()
          ? std::abs(row.lambda + row.softness * (u + row.bias)) / (row.mass + row.softness)
          : std::abs(std::max(row.lower, row.lambda - row.mass * (u - row.bound)) - row.lambda) / row.mass;
  return r + 0.0 * (u + row.lambda);
}

}  // namespace

void set_tangents(PointContact& contact) {
  const Vec3& n = contact.n;
  // 1/sqrt(3): at least one component of a unit vector is that large, so neither branch divides by a small number.
  constexpr double kLarge = 0.57735;
  contact.t1 = std::abs(n.x()) > kLarge ? Vec3(n.y(), -n.x(), 0.0) : Vec3(0.0, n.z(), -n.y());
  contact.t1 /= std::sqrt(contact.t1.squaredNorm());
  contact.t2 = n.cross(contact.t1);
}

Vec3 nearest_moment(const Turning& turning, const Vec3& moment, double l_n) {
  const double most_n = turning.torsional * std::max(0.0, l_n), most_t = turning.rolling * std::max(0.0, l_n);
  const double length = std::sqrt(moment.y() * moment.y() + moment.z() * moment.z());
  const double share = length > most_t ? most_t / length : 1.0;
  return {std::clamp(moment.x(), -most_n, most_n), share * moment.y(), share * moment.z()};
}

Mat3 inverse_mass(const SolverBody& A, const SolverBody& B, const PointContact& c) {
  const Mat3 RA = cross_matrix(c.rA), RB = cross_matrix(c.rB);
  Mat3 frame;
  frame << c.n, c.t1, c.t2;
  const Mat3 K_W = (A.inv_mass + B.inv_mass) * Mat3::Identity() + RA * A.inv_I_W * RA.transpose() +
                   RB * B.inv_I_W * RB.transpose();
  const Mat3 K = frame.transpose() * K_W * frame;
  return 0.5 * (K + K.transpose());
}

Vec3 relative_velocity(const SolverBody& A, const SolverBody& B, const Vec3& rA, const Vec3& rB) {
  return B.v + B.w.cross(rB) - A.v - A.w.cross(rA);
}

Vec3 relative_start_velocity(const SolverBody& A, const SolverBody& B, const Vec3& rA, const Vec3& rB) {
  return B.v0 + B.w0.cross(rB) - A.v0 - A.w0.cross(rA);
}

void prepare(ContactProblem& problem, const BoundSettings& settings) {
  for (PointContact& c : problem.contacts) {
    update_masses(problem.bodies, c);
    c.un0 = c.n.dot(relative_start_velocity(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB));
    c.bound = bound_of(c.separation, problem.h, settings);
  }
  if (settings.push_fraction == 0.0) set_bounds_by_deepest(problem);
  for (Turning& turning : problem.turnings) update_masses(problem, turning);
  for (ScalarRow& row : problem.rows) {
    const double k = inverse_mass_along(problem.bodies[row.a], row.rA, row.n, row.n) +
                     inverse_mass_along(problem.bodies[row.b], row.rB, row.n, row.n);
    row.mass = k > 0.0 ? 1.0 / k : 0.0;
  }
}

void apply_impulse(SolverBody& A, SolverBody& B, const Vec3& rA, const Vec3& rB, const Vec3& impulse) {
  A.v -= A.inv_mass * impulse;
  A.w -= A.inv_I_W * rA.cross(impulse);
  B.v += B.inv_mass * impulse;
  B.w += B.inv_I_W * rB.cross(impulse);
}

void apply_moment(SolverBody& A, SolverBody& B, const Vec3& moment) {
  A.w -= A.inv_I_W * moment;
  B.w += B.inv_I_W * moment;
}

void apply_stored_moments(ContactProblem& problem) {
  for (const Turning& turning : problem.turnings) {
    const PointContact& c = problem.contacts[turning.contact];
    apply_moment(problem.bodies[c.a], problem.bodies[c.b], in_world(c, turning.lambda));
  }
}

void apply_stored_impulses(ContactProblem& problem) {
  for (const ScalarRow& row : problem.rows) {
    apply_impulse(problem.bodies[row.a], problem.bodies[row.b], row.rA, row.rB, row.lambda * row.n);
  }
  for (const PointContact& c : problem.contacts) {
    apply_impulse(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB, in_world(c, c.lambda));
  }
  apply_stored_moments(problem);
}

double compute_residual(const ContactProblem& problem) {
  // max() drops a NaN, so 0 * (every term) is summed up beside it: 0 if all are finite, else NaN.
  double largest = 0.0, poison = 0.0;
  const auto take = [&](double r) {
    largest = std::max(largest, r);
    poison += 0.0 * r;
  };
  for (const ScalarRow& row : problem.rows) take(row_residual(problem, row));
  for (const PointContact& c : problem.contacts) take(contact_residual(problem, c));
  for (const Turning& turning : problem.turnings) take(turning_residual(problem, turning));
  return largest + poison;
}

double drift_speed(const ContactProblem& problem, const PointContact& c) {
  const double u = c.n.dot(relative_velocity(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB));
  return problem.drift == ContactProblem::Drift::average ? 0.5 * (c.un0 + u) : u;
}

ContactProblem::Drift choose_drift(const ContactProblem& problem) {
  constexpr double kSlack = 1e-8;  // [m] far below what can be seen, far above the rounding of a gap
  const auto stays_open = [&](std::uint32_t a, std::uint32_t b, const Vec3& n, const Vec3& rA, const Vec3& rB,
                              double gap, double allowed) {
    const SolverBody &A = problem.bodies[a], &B = problem.bodies[b];
    const Vec3 mean = 0.5 * (relative_start_velocity(A, B, rA, rB) + relative_velocity(A, B, rA, rB));
    return gap + problem.h * n.dot(mean) >= std::min({gap, allowed, 0.0}) - kSlack;
  };
  for (const PointContact& c : problem.contacts) {
    const double allowed = c.separation + problem.h * c.bound;
    if (!stays_open(c.a, c.b, c.n, c.rA, c.rB, c.separation, allowed)) return ContactProblem::Drift::end;
  }
  for (const ScalarRow& row : problem.rows) {
    if (!row.is_soft() && !row.is_two_sided() &&
        !stays_open(row.a, row.b, row.n, row.rA, row.rB, row.gap, 0.0)) {
      return ContactProblem::Drift::end;
    }
  }
  return ContactProblem::Drift::average;
}

}  // namespace tumble
