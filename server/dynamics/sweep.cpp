// Builds the arrays that a Gauss-Seidel sweep runs over, and brings the impulses back.
#include "dynamics/sweep.h"

namespace tumble {
namespace {

SweptDirection make_direction(const SolverBody& A, const SolverBody& B, const Vec3& d, const Vec3& rA,
                              const Vec3& rB) {
  const Vec3 jA = rA.cross(d), jB = rB.cross(d);
  return {Lanes(d), Lanes(jA), Lanes(jB), Lanes(A.inv_I_W * jA), Lanes(B.inv_I_W * jB)};
}

/// Angular part of the velocity along `d` for a unit impulse along `impulse` [1/kg].
double answer(const SweptDirection& d, const SweptDirection& impulse) {
  return d.jA.vec3().dot(impulse.gA.vec3()) + d.jB.vec3().dot(impulse.gB.vec3());
}

SweptContact make_contact(const ContactProblem& problem, const PointContact& c) {
  const SolverBody &A = problem.bodies[c.a], &B = problem.bodies[c.b];
  SweptContact s;
  s.a = c.a;
  s.b = c.b;
  s.inv_mass_A = A.inv_mass;
  s.inv_mass_B = B.inv_mass;
  s.n = make_direction(A, B, c.n, c.rA, c.rB);
  s.t1 = make_direction(A, B, c.t1, c.rA, c.rB);
  s.t2 = make_direction(A, B, c.t2, c.rA, c.rB);
  s.mass_n = c.mass_n;
  s.mass_t = c.mass_t;
  s.friction = c.friction;
  s.bound = c.bound;
  s.l_n = c.lambda.x();
  s.l_1 = c.lambda.y();
  s.l_2 = c.lambda.z();
  const double inv_mass = A.inv_mass + B.inv_mass;
  const double k11 = inv_mass + answer(s.t1, s.t1), k22 = inv_mass + answer(s.t2, s.t2),
               k12 = answer(s.t1, s.t2);
  s.k_n = 1.0 / c.mass_n;
  s.k_t = 1.0 / c.mass_t;
  s.k_1n = answer(s.t1, s.n);
  s.k_2n = answer(s.t2, s.n);
  const double det = k11 * k22 - k12 * k12;
  s.i11 = k22 / det;
  s.i12 = -k12 / det;
  s.i22 = k11 / det;
  return s;
}

/// d = 0: velocity() is d . (w_b - w_a), apply() turns.
SweptDirection make_turn(const SolverBody& A, const SolverBody& B, const Vec3& d) {
  return {Lanes(), Lanes(d), Lanes(d), Lanes(A.inv_I_W * d), Lanes(B.inv_I_W * d)};
}

SweptTurning make_turning(const ContactProblem& problem, const Turning& turning, std::uint32_t swept) {
  const PointContact& c = problem.contacts[turning.contact];
  const SolverBody &A = problem.bodies[c.a], &B = problem.bodies[c.b];
  return {swept, turning, make_turn(A, B, c.n), make_turn(A, B, c.t1), make_turn(A, B, c.t2)};
}

}  // namespace

Sweep make_sweep(const ContactProblem& problem) {
  Sweep sweep;
  sweep.bodies.reserve(problem.bodies.size());
  for (const SolverBody& body : problem.bodies) sweep.bodies.push_back({Lanes(body.v), Lanes(body.w)});
  sweep.contacts.reserve(problem.contacts.size());
  auto turning = problem.turnings.begin();
  for (std::uint32_t i = 0; i < problem.contacts.size(); ++i) {
    const PointContact& c = problem.contacts[i];
    // A contact between two bodies that cannot be moved has no mass and nothing to solve.
    if (c.mass_n == 0.0) continue;
    while (turning != problem.turnings.end() && turning->contact < i) ++turning;
    if (turning != problem.turnings.end() && turning->contact == i) {
      const auto swept = static_cast<std::uint32_t>(sweep.contacts.size());
      sweep.turnings.push_back(make_turning(problem, *turning, swept));
    }
    sweep.contacts.push_back(make_contact(problem, c));
  }
  sweep.rows.reserve(problem.rows.size());
  for (const ScalarRow& row : problem.rows) {
    if (row.mass == 0.0) continue;
    const SolverBody &A = problem.bodies[row.a], &B = problem.bodies[row.b];
    sweep.rows.push_back({row.a, row.b, A.inv_mass, B.inv_mass, make_direction(A, B, row.n, row.rA, row.rB),
                          row.mass, row.softness, row.bias, row.bound, row.lower, row.lambda, row.is_soft()});
  }
  return sweep;
}

void update_impulses(const Sweep& sweep, ContactProblem& problem) {
  auto row = sweep.rows.begin();
  for (ScalarRow& to : problem.rows) {
    if (to.mass == 0.0) continue;
    apply_impulse(problem.bodies[to.a], problem.bodies[to.b], to.rA, to.rB, (row->l - to.lambda) * to.n);
    to.lambda = (row++)->l;
  }
  auto contact = sweep.contacts.begin();
  for (PointContact& to : problem.contacts) {
    if (to.mass_n == 0.0) continue;
    const Vec3 l(contact->l_n, contact->l_1, contact->l_2), change = l - to.lambda;
    apply_impulse(problem.bodies[to.a], problem.bodies[to.b], to.rA, to.rB, in_world(to, change));
    to.lambda = l;
    ++contact;
  }
  auto turning = sweep.turnings.begin();
  for (Turning& to : problem.turnings) {
    const PointContact& c = problem.contacts[to.contact];
    if (c.mass_n == 0.0) continue;
    const Vec3& l = (turning++)->law.lambda;
    apply_moment(problem.bodies[c.a], problem.bodies[c.b], in_world(c, l - to.lambda));
    to.lambda = l;
  }
}

double visit_turnings(Sweep& sweep) {
  double largest = 0.0;
  for (SweptTurning& turning : sweep.turnings) {
    const SweptContact& c = sweep.contacts[turning.contact];
    largest = std::max(largest, visit_turning(turning, c.l_n, sweep.bodies[c.a], sweep.bodies[c.b]));
  }
  return largest;
}

double sweep_once(Sweep& sweep, SweepOrder order) {
  double largest = 0.0;
  const auto contact = [&](SweptContact& c) {
    SweptBody &A = sweep.bodies[c.a], &B = sweep.bodies[c.b];
    largest = std::max(largest, visit_contact(c, {.push = -c.bound}, A, B));
  };
  const auto row = [&](SweptRow& r) {
    largest = std::max(largest, visit_row(r, sweep.bodies[r.a], sweep.bodies[r.b]));
  };
  if (order == SweepOrder::forward) {
    std::for_each(sweep.rows.begin(), sweep.rows.end(), row);
    std::for_each(sweep.contacts.begin(), sweep.contacts.end(), contact);
    largest = std::max(largest, visit_turnings(sweep));
  } else {
    largest = std::max(largest, visit_turnings(sweep));
    std::for_each(sweep.contacts.rbegin(), sweep.contacts.rend(), contact);
    std::for_each(sweep.rows.rbegin(), sweep.rows.rend(), row);
  }
  return std::sqrt(largest);
}

}  // namespace tumble
