// See balance.h. Least squares by the method of multipliers: with W the slack of every impulse to its bound,
//   (J^T W J + epsilon M) y = -p,   lambda += W J y,   p += J^T W J y,
// p = M (v - v0), the momentum that the step leaves over once the velocities of its start are dropped too. epsilon keeps what no contact holds (a ball may spin) solvable.
#include "dynamics/balance.h"

#include <algorithm>
#include <cmath>

#include "dynamics/velocity_system.h"

namespace tumble {
namespace {

/// [1/s] against loads of g/h per mass: each pass leaves this share of the momentum, at a condition that keeps 8 digits.
constexpr double kSoftness = 1e-7;
constexpr int kPasses = 4;

/// An impulse and how easily its components change [kg/s].
struct Support {
  Coupling joins;
  Vec3 weight;
  Vec3* contact = nullptr;  // one of the two
  double* row = nullptr;
};

/// Friction impulse [N s].
double friction_impulse(const PointContact& c) {
  return std::sqrt(c.lambda.y() * c.lambda.y() + c.lambda.z() * c.lambda.z());
}

class Balance {
 public:
  explicit Balance(ContactProblem& problem)
      : problem_(problem), system_(problem, VelocitySystem::find_pattern(problem)) {}
  void find();

 private:
  void collect_momentum();
  void collect_supports();
  bool factorize();

  ContactProblem& problem_;
  VelocitySystem system_;
  std::vector<Vec6> momentum_, y_;  // by position
  std::vector<Support> supports_;
};

void Balance::collect_momentum() {
  std::vector<Vec6> v, v0;
  system_.load_velocities(v);
  system_.load_start_velocities(v0);
  momentum_.clear();
  for (std::size_t i = 0; i < v.size(); ++i) momentum_.push_back(system_.momentum(i, v[i] - v0[i]));
}

void Balance::collect_supports() {
  const double per_second = 1.0 / problem_.h;
  for (PointContact& c : problem_.contacts) {
    if (c.mass_n == 0.0 || !(c.lambda.x() > 0.0)) continue;
    const double slack = std::max(0.0, c.friction * c.lambda.x() - friction_impulse(c));
    Support& support = supports_.emplace_back();
    support.joins = system_.make_coupling(c);
    support.weight = per_second * Vec3(c.lambda.x(), slack, slack);
    support.contact = &c.lambda;
  }
  for (ScalarRow& row : problem_.rows) {
    if (row.mass == 0.0) continue;
    const Coupling joins = system_.make_coupling(row);
    if (row.is_soft()) {  // without the velocity it pulls with another force, whatever holds the rest
      const Vec3 u = relative_velocity(problem_.bodies[row.a], problem_.bodies[row.b], row.rA, row.rB);
      const double change = row.softness * row.n.dot(u);
      row.lambda += change;
      system_.add_impulse(joins, Vec3(change, 0.0, 0.0), momentum_);
      continue;
    }
    const double slack = row.is_two_sided() ? row.mass : row.lambda;
    if (!(slack > 0.0)) continue;
    Support& support = supports_.emplace_back();
    support.joins = joins;
    support.weight = Vec3(per_second * slack, 0.0, 0.0);
    support.row = &row.lambda;
  }
}

bool Balance::factorize() {
  system_.set_mass(kSoftness);
  for (const Support& support : supports_) system_.add_stiffness(support.joins, support.weight.asDiagonal());
  return system_.factorize();
}

void Balance::find() {
  collect_momentum();
  collect_supports();
  if (!factorize()) return;
  for (int pass = 0; pass < kPasses; ++pass) {
    y_ = momentum_;
    system_.solve(y_);
    for (const Support& support : supports_) {
      const Vec3 change = -support.weight.cwiseProduct(system_.velocity(support.joins, y_));
      system_.add_impulse(support.joins, change, momentum_);
      if (support.contact) {
        *support.contact += change;
      } else {
        *support.row += change.x();
      }
    }
  }
}

}  // namespace

bool balance_impulses(ContactProblem& problem, double tolerance) {
  std::vector<Vec3> contacts;
  std::vector<double> rows;
  for (const PointContact& c : problem.contacts) contacts.push_back(c.lambda);
  for (const ScalarRow& row : problem.rows) rows.push_back(row.lambda);
  Balance(problem).find();
  for (SolverBody& body : problem.bodies) {
    if (body.inv_mass > 0.0) body.v = body.w = Vec3::Zero();
  }
  if (compute_residual(problem) < tolerance) return true;
  for (std::size_t i = 0; i < contacts.size(); ++i) problem.contacts[i].lambda = contacts[i];
  for (std::size_t i = 0; i < rows.size(); ++i) problem.rows[i].lambda = rows[i];
  return false;
}

}  // namespace tumble
