// Builds the arrays that a Gauss-Seidel sweep runs over, and brings the impulses back.
#include "dynamics/sweep.h"

namespace tumble {
namespace {

SweptDirection make_direction(const SolverBody& A, const SolverBody& B, const Vec3& d, const Vec3& rA, const Vec3& rB) {
  SweptDirection s{d, rA.cross(d), rB.cross(d), Vec3::Zero(), Vec3::Zero()};
  s.gA = A.inv_I_W * s.jA;
  s.gB = B.inv_I_W * s.jB;
  return s;
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
  const double k11 = inv_mass + s.t1.jA.dot(s.t1.gA) + s.t1.jB.dot(s.t1.gB);
  const double k22 = inv_mass + s.t2.jA.dot(s.t2.gA) + s.t2.jB.dot(s.t2.gB);
  const double k12 = s.t1.jA.dot(s.t2.gA) + s.t1.jB.dot(s.t2.gB);
  const double det = k11 * k22 - k12 * k12;
  s.i11 = k22 / det;
  s.i12 = -k12 / det;
  s.i22 = k11 / det;
  return s;
}

}  // namespace

Sweep make_sweep(const ContactProblem& problem) {
  Sweep sweep;
  sweep.twists.reserve(problem.bodies.size());
  for (const SolverBody& body : problem.bodies) sweep.twists.push_back({body.v, body.w});
  sweep.contacts.reserve(problem.contacts.size());
  for (const PointContact& c : problem.contacts) {
    // A contact between two bodies that cannot be moved has no mass and nothing to solve.
    if (c.mass_n > 0.0) sweep.contacts.push_back(make_contact(problem, c));
  }
  sweep.rows.reserve(problem.rows.size());
  for (const ScalarRow& row : problem.rows) {
    if (row.mass == 0.0) continue;
    const SolverBody &A = problem.bodies[row.a], &B = problem.bodies[row.b];
    sweep.rows.push_back({row.a, row.b, A.inv_mass, B.inv_mass, make_direction(A, B, row.n, row.rA, row.rB), row.mass,
                          row.softness, row.bias, row.bound, row.lower, row.lambda, row.is_soft()});
  }
  return sweep;
}

void store_impulses(const Sweep& sweep, ContactProblem& problem) {
  auto contact = sweep.contacts.begin();
  for (PointContact& c : problem.contacts) {
    if (c.mass_n == 0.0) continue;
    c.lambda = Vec3(contact->l_n, contact->l_1, contact->l_2);
    ++contact;
  }
  auto swept = sweep.rows.begin();
  for (ScalarRow& row : problem.rows) {
    if (row.mass > 0.0) row.lambda = (swept++)->l;
  }
}

}  // namespace tumble
