// See balance.h. Least squares by the method of multipliers: with W the slack of every impulse to its bound,
//   (J^T W J + epsilon M) y = -p,   lambda += W J y,   p += J^T W J y,
// p = M (v - v0), the momentum that the step leaves over once the velocities of its start are dropped too. epsilon keeps what no contact holds (a ball may spin) solvable.
#include "dynamics/balance.h"

#include <cmath>

#include "dynamics/block_cholesky.h"

namespace tumble {
namespace {

/// [1/s] against loads of g/h per mass: each pass leaves this share of the momentum, at a condition that keeps 8 digits.
constexpr double kSoftness = 1e-7;
constexpr int kPasses = 4;
constexpr std::uint32_t kHeld = ~0u;

/// One direction of an impulse.
struct Direction {
  std::uint32_t body[2];  // positions in the factorization, or kHeld
  Vec6 J[2];
  double weight = 0.0;  // how easily it changes [kg/s]
  double* lambda = nullptr;
};

/// Friction impulse [N s].
double friction_impulse(const PointContact& c) {
  return std::sqrt(c.lambda.y() * c.lambda.y() + c.lambda.z() * c.lambda.z());
}

class Balance {
 public:
  explicit Balance(ContactProblem& problem)
      : problem_(problem), number_(problem.bodies.size(), kHeld), matrix_(make_pattern()) {}
  void find();

 private:
  BlockPattern make_pattern();
  template <typename Constraint>
  Direction direction(const Constraint& c, const Vec3& d, double weight, double& lambda) const;
  void change(const Direction& d, double by);
  void collect_momentum();
  void collect_directions();
  bool factorize();

  ContactProblem& problem_;
  std::vector<std::uint32_t> number_;
  BlockCholesky matrix_;
  std::vector<Vec6> momentum_, y_;  // by position
  std::vector<Direction> directions_;
};

BlockPattern Balance::make_pattern() {
  std::uint32_t movable = 0;
  for (std::size_t i = 0; i < number_.size(); ++i)
    if (problem_.bodies[i].inv_mass > 0.0) number_[i] = movable++;
  std::vector<BlockPattern::Edge> edges;
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    if (number_[a] != kHeld && number_[b] != kHeld) edges.emplace_back(number_[a], number_[b]);
  };
  for (const PointContact& c : problem_.contacts) join(c.a, c.b);
  for (const ScalarRow& row : problem_.rows) join(row.a, row.b);
  return BlockPattern(movable, edges);
}

template <typename Constraint>
Direction Balance::direction(const Constraint& c, const Vec3& d, double weight, double& lambda) const {
  Direction direction;
  direction.J[0] << -d, -c.rA.cross(d);
  direction.J[1] << d, c.rB.cross(d);
  direction.body[0] = number_[c.a] == kHeld ? kHeld : matrix_.pattern().position(number_[c.a]);
  direction.body[1] = number_[c.b] == kHeld ? kHeld : matrix_.pattern().position(number_[c.b]);
  direction.weight = weight;
  direction.lambda = &lambda;
  return direction;
}

void Balance::change(const Direction& d, double by) {
  *d.lambda += by;
  for (int k = 0; k < 2; ++k)
    if (d.body[k] != kHeld) momentum_[d.body[k]] += by * d.J[k];
}

void Balance::collect_momentum() {
  momentum_.assign(matrix_.pattern().size(), Vec6::Zero());
  for (std::size_t i = 0; i < number_.size(); ++i) {
    if (number_[i] == kHeld) continue;
    const SolverBody& body = problem_.bodies[i];
    momentum_[matrix_.pattern().position(number_[i])] << (body.v - body.v0) / body.inv_mass,
        body.inv_I_W.inverse() * (body.w - body.w0);
  }
}

void Balance::collect_directions() {
  const double per_second = 1.0 / problem_.h;
  for (PointContact& c : problem_.contacts) {
    const double slack = c.friction * c.lambda.x() - friction_impulse(c);
    directions_.push_back(direction(c, c.n, per_second * c.lambda.x(), c.lambda.x()));
    directions_.push_back(direction(c, c.t1, per_second * slack, c.lambda.y()));
    directions_.push_back(direction(c, c.t2, per_second * slack, c.lambda.z()));
  }
  for (ScalarRow& row : problem_.rows) {
    if (row.is_soft()) {  // without the velocity it pulls with another force, whatever holds the rest
      const Vec3 u = relative_velocity(problem_.bodies[row.a], problem_.bodies[row.b], row.rA, row.rB);
      change(direction(row, row.n, 0.0, row.lambda), row.softness * row.n.dot(u));
    } else {
      const double slack = row.is_two_sided() ? row.mass : row.lambda;
      directions_.push_back(direction(row, row.n, per_second * slack, row.lambda));
    }
  }
  std::erase_if(directions_, [](const Direction& d) { return !(d.weight > 0.0); });
}

bool Balance::factorize() {
  matrix_.set_zero();
  for (std::size_t i = 0; i < number_.size(); ++i) {
    if (number_[i] == kHeld) continue;
    const SolverBody& body = problem_.bodies[i];
    Mat6& block = matrix_.diagonal(matrix_.pattern().position(number_[i]));
    block.topLeftCorner<3, 3>().diagonal().setConstant(kSoftness / body.inv_mass);
    block.bottomRightCorner<3, 3>() = kSoftness * body.inv_I_W.inverse();
  }
  for (const Direction& d : directions_) {
    for (int k = 0; k < 2; ++k)
      if (d.body[k] != kHeld) matrix_.diagonal(d.body[k]) += d.weight * d.J[k] * d.J[k].transpose();
    if (d.body[0] == kHeld || d.body[1] == kHeld) continue;
    const int later = d.body[0] > d.body[1] ? 0 : 1;
    matrix_.below(matrix_.pattern().block(d.body[0], d.body[1])) +=
        d.weight * d.J[later] * d.J[1 - later].transpose();
  }
  return matrix_.factorize();
}

void Balance::find() {
  collect_momentum();
  collect_directions();
  if (!factorize()) return;
  for (int pass = 0; pass < kPasses; ++pass) {
    y_ = momentum_;
    matrix_.solve(y_);
    for (const Direction& d : directions_) {
      double along = 0.0;
      for (int k = 0; k < 2; ++k)
        if (d.body[k] != kHeld) along += d.J[k].dot(y_[d.body[k]]);
      change(d, -d.weight * along);
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
