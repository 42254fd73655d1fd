// See cone_newton.h. With multipliers l, stiffness k and De Saxce's shift the velocities of one problem are the root of
//   F(v) = M (v - v*) - sum J^T P(l - k (J v + (mu |u_t| - b) e0)),   P projection on the cone of friction,
// and the projected impulses are the next multipliers (Rockafellar 1976; De Saxce, Feng 1998). The derivative of the shift
// is taken along, else each problem leaves half of what the one before it left.
#include "dynamics/cone_newton.h"

#include <algorithm>
#include <cmath>

namespace tumble {
namespace {

/// Stiffness over the mass that a contact moves. Low at first: hardly anything then changes between pressing and not; ten
/// times more after each problem that Newton's method solved quickly.
constexpr double kSoftest = 1e2, kStiffest = 1e6;
constexpr int kQuick = 4;
constexpr int kNewtonSteps = 8;  // of one problem
constexpr int kMostCompromiseSteps = 30;
constexpr int kMostHalvings = 8;
constexpr double kSolved = 1e-11;  // [m/s] mean defect of a problem

struct FrictionCone {
  Coupling joins;
  enum class Kind { contact, half_line, line, spring } kind;
  double bound, friction, stiffness;
  Vec3* contact = nullptr;  // where the impulse goes: one of the two
  double* row = nullptr;
  Vec3 l, p;  // multiplier; impulse
  Mat3 G;     // - dp/du
};

/// Nearest point of the cone |y_t| <= mu y_n, and its derivative.
Vec3 project(const Vec3& y, double mu, Mat3* derivative) {
  const double t = std::sqrt(y.y() * y.y() + y.z() * y.z());
  if (t <= mu * y.x()) {
    if (derivative) derivative->setIdentity();
    return y;
  }
  if (mu * t <= -y.x()) {
    if (derivative) derivative->setZero();
    return Vec3::Zero();
  }
  const double e1 = y.y() / t, e2 = y.z() / t, scale = 1.0 / (1.0 + mu * mu);
  const double normal = scale * (y.x() + mu * t);
  if (derivative) {
    const Vec3 along(1.0, mu * e1, mu * e2), across(0.0, -e2, e1);
    *derivative = scale * along * along.transpose() + (mu * normal / t) * across * across.transpose();
  }
  return {normal, mu * normal * e1, mu * normal * e2};
}

class ConeNewton {
 public:
  ConeNewton(ContactProblem& problem, VelocitySystem& system, double tolerance, BestImpulses& best);
  int solve(int max_iterations);
  int find_compromise();

 private:
  void add_contact(PointContact& c);
  void add_row(ScalarRow& row);
  Vec3 impulse(const FrictionCone& cone, const Vec3& u, Mat3* G) const;
  double update_defect(const std::vector<Vec6>& v, bool linearize);
  bool step();
  int solve_problem(int max_iterations);
  void store();

  VelocitySystem& system_;
  const double tolerance_;
  BestImpulses& best_;
  std::vector<FrictionCone> cones_;
  std::vector<Vec6> free_, v_, defect_, dv_, trial_;  // by position
  double mass_ = 0.0;                                 // [kg] of all bodies
  double rigidity_ = kSoftest;
};

ConeNewton::ConeNewton(ContactProblem& problem, VelocitySystem& system, double tolerance, BestImpulses& best)
    : system_(system), tolerance_(tolerance), best_(best) {
  best.restore_start();
  apply_stored_moments(problem);
  system.load_velocities(free_);
  best.restore();
  system.load_velocities(v_);
  defect_ = dv_ = trial_ = v_;
  for (std::size_t i = 0; i < v_.size(); ++i) mass_ += system.momentum(i, Vec6::Unit(0)).x();
  for (PointContact& c : problem.contacts) {
    if (c.mass_n > 0.0) add_contact(c);
  }
  for (ScalarRow& row : problem.rows) {
    if (row.mass > 0.0) add_row(row);
  }
}

void ConeNewton::add_contact(PointContact& c) {
  FrictionCone& cone = cones_.emplace_back();
  cone.joins = system_.make_coupling(c);
  cone.kind = c.friction > kFrictionless ? FrictionCone::Kind::contact : FrictionCone::Kind::half_line;
  cone.bound = c.bound;
  cone.friction = c.friction;
  cone.stiffness = c.mass_n;
  cone.contact = &c.lambda;
  cone.l = cone.kind == FrictionCone::Kind::contact ? c.lambda : Vec3(c.lambda.x(), 0.0, 0.0);
}

void ConeNewton::add_row(ScalarRow& row) {
  FrictionCone& cone = cones_.emplace_back();
  cone.joins = system_.make_coupling(row);
  cone.kind = row.is_soft()        ? FrictionCone::Kind::spring
              : row.is_two_sided() ? FrictionCone::Kind::line
                                   : FrictionCone::Kind::half_line;
  cone.bound = row.is_soft() ? -row.bias : row.bound;
  cone.friction = 0.0;
  cone.stiffness = row.is_soft() ? row.softness : row.mass;
  cone.row = &row.lambda;
  cone.l = Vec3(row.lambda, 0.0, 0.0);
}

/// p(u), and G = - dp/du.
Vec3 ConeNewton::impulse(const FrictionCone& cone, const Vec3& u, Mat3* G) const {
  if (G) G->setZero();
  if (cone.kind == FrictionCone::Kind::spring) {
    if (G) (*G)(0, 0) = cone.stiffness;
    return {-cone.stiffness * (u.x() - cone.bound), 0.0, 0.0};
  }
  const double k = rigidity_ * cone.stiffness;
  if (cone.kind != FrictionCone::Kind::contact) {
    const double y = cone.l.x() - k * (u.x() - cone.bound);
    if (cone.kind == FrictionCone::Kind::half_line && !(y > 0.0)) return Vec3::Zero();
    if (G) (*G)(0, 0) = k;
    return {y, 0.0, 0.0};
  }
  const double slip = std::sqrt(u.y() * u.y() + u.z() * u.z());
  const Vec3 p =
      project(cone.l - k * Vec3(u.x() + cone.friction * slip - cone.bound, u.y(), u.z()), cone.friction, G);
  if (G && slip > 0.0) {
    const Vec3 shift(0.0, cone.friction * u.y() / slip, cone.friction * u.z() / slip);
    const Vec3 column = G->col(0);
    *G += column * shift.transpose();
  }
  if (G) *G *= k;
  return p;
}

/// defect = -F(v); returns F . M^-1 F, twice the energy that it would give [J].
double ConeNewton::update_defect(const std::vector<Vec6>& v, bool linearize) {
  for (std::size_t i = 0; i < v.size(); ++i) defect_[i] = -system_.momentum(i, v[i] - free_[i]);
  for (FrictionCone& cone : cones_) {
    const Vec3 u = system_.velocity(cone.joins, v) + cone.joins.offset;
    const Vec3 p = impulse(cone, u, linearize ? &cone.G : nullptr);
    if (linearize) cone.p = p;
    system_.add_impulse(cone.joins, p, defect_);
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < v.size(); ++i) sum += defect_[i].dot(system_.answer(i, defect_[i]));
  return sum;
}

/// False if no part of Newton's step brings the root nearer.
bool ConeNewton::step() {
  const double before = update_defect(v_, true);
  system_.set_mass();
  for (const FrictionCone& cone : cones_) {
    if (!cone.G.isZero(0.0)) system_.add_stiffness(cone.joins, cone.G);
  }
  if (!system_.factorize()) return false;
  dv_ = defect_;
  system_.solve(dv_);
  double share = 1.0;
  for (int i = 0; i < kMostHalvings; ++i, share *= 0.5) {
    for (std::size_t k = 0; k < v_.size(); ++k) trial_[k] = v_[k] + share * dv_[k];
    if (update_defect(trial_, false) < (1.0 - 0.1 * share) * before) {
      std::swap(v_, trial_);
      return true;
    }
  }
  return false;
}

/// Returns the number of factorizations.
int ConeNewton::solve_problem(int max_iterations) {
  for (int steps = 0; steps < max_iterations;) {
    ++steps;
    if (!step() || update_defect(v_, false) < kSolved * kSolved * mass_) return steps;
  }
  return max_iterations;
}

void ConeNewton::store() {
  update_defect(v_, true);
  for (FrictionCone& cone : cones_) {
    cone.l = cone.p;
    if (cone.contact) {
      *cone.contact = cone.p;
    } else {
      *cone.row = cone.p.x();
    }
  }
}

int ConeNewton::solve(int max_iterations) {
  int iterations = 0;
  while (iterations < max_iterations) {
    const int steps = solve_problem(std::min(kNewtonSteps, max_iterations - iterations));
    iterations += steps;
    store();
    const double residual = best_.offer();
    if (residual < tolerance_ || !(residual < kInfinity)) break;
    system_.load_velocities(v_);
    if (steps <= kQuick) rigidity_ = std::min(kStiffest, 10.0 * rigidity_);
  }
  return iterations;
}

int ConeNewton::find_compromise() {
  const int steps = solve_problem(kMostCompromiseSteps);
  store();
  best_.offer();
  return steps;
}

}  // namespace

int find_compromise(ContactProblem& problem, VelocitySystem& system, BestImpulses& best) {
  best.drop();
  return ConeNewton(problem, system, 0.0, best).find_compromise();
}

int run_cone_newton(ContactProblem& problem, VelocitySystem& system, double tolerance, int max_iterations,
                    BestImpulses& best) {
  return ConeNewton(problem, system, tolerance, best).solve(max_iterations);
}

}  // namespace tumble
