// See interior_point.h. With J' = J whose normal row is divided by mu and z = (mu l_n, l_t), the Coulomb problem is
//   M (v - v*) = J'^T z,   s = J' v + c(v),   s in L, z in L, s o z = 0,   c = (|u_t| - b/mu, 0, 0)  (De Saxce),
// solved by Mehrotra's predictor and corrector in Nesterov-Todd scaling with c renewed in every iteration (Acary,
// Brogliato, Melanz 2023; Alizadeh, Goldfarb 2003). Rows without friction have J' = J in the first row, zeros below.
#include "dynamics/interior_point.h"

#include <algorithm>
#include <cmath>

#include "dynamics/block_cholesky.h"
#include "dynamics/lorentz_cone.h"

namespace tumble {
namespace {

using Mat36 = Eigen::Matrix<double, 3, 6>;

constexpr int kMaxIterations = 40;  // the largest pyramid measured, 210 bodies, needs 33
constexpr int kMaxStalls = 10;
constexpr double kToBoundary = 0.99;
/// Smaller coefficients are left to the sweeps that follow: dividing by them would drown the normal condition.
constexpr double kFrictionless = 1e-6;
/// Rigid two-sided rows are springs whose rest length follows the impulse (method of multipliers): this many times
/// stiffer than the row's own mass, so each iteration leaves a millionth of the error.
constexpr double kTieStiffness = 1e6;

constexpr std::uint32_t kImmovable = ~0u;

/// Which bodies a cone or row joins, by position in the elimination order, ascending, and their block of the matrix.
struct Joined {
  std::uint32_t body[2] = {kImmovable, kImmovable};
  std::uint32_t block = 0;
};

struct ConeConstraint {
  Joined joined;
  Mat36 J[2];               // of the scaled velocity with respect to (v, w) of the two bodies
  Vec3 offset;              // what immovable bodies add to it
  double bound;             // b/mu
  double friction, mass_n;  // friction 1 and one-dimensional where there is none
  Vec3* contact = nullptr;  // where the impulse goes: one of the two
  double* row = nullptr;
  Vec3 s, z, ds, dz, target, gap;
  ConeScaling scaling;
};

/// lambda = -softness (u + bias): a spring, or a two-sided rigid row in the limit of the iterations.
struct SoftRow {
  Joined joined;
  Vec6 J[2];
  double softness, bias;
  bool spring;
  double* row;
  double lambda, defect, change;
};

Vec6 jacobian_row(const Vec3& d, const Vec3& r, double sign) {
  Vec6 row;
  row << sign * d, sign * r.cross(d);
  return row;
}

class InteriorPoint {
 public:
  InteriorPoint(ContactProblem& problem, double tolerance, BestImpulses& best);
  int solve();

 private:
  static std::vector<std::uint32_t> number_movable(const ContactProblem& problem);
  static BlockPattern make_pattern(const ContactProblem& problem, const std::vector<std::uint32_t>& number);
  void add_contact(PointContact& c);
  void add_row(ScalarRow& row);
  /// Places a and b; true if a comes second.
  bool join(std::uint32_t a, std::uint32_t b, Joined& joined) const;
  Vec3 immovable_velocity(std::uint32_t a, std::uint32_t b, const Vec3& rA, const Vec3& rB) const;

  void start();
  Vec3 velocity(const ConeConstraint& cone, const std::vector<Vec6>& v) const;
  double velocity(const SoftRow& row, const std::vector<Vec6>& v) const;
  void update_defects();
  bool factorize();
  void find_direction();
  double step_length() const;
  void predict_and_correct();
  void advance(double step);
  void store();

  ContactProblem& problem_;
  const double tolerance_;
  BestImpulses& best_;
  const std::vector<std::uint32_t> number_;  // of movable bodies; kImmovable for the others
  BlockCholesky matrix_;
  std::vector<Mat6> mass_;
  std::vector<Vec6> v_, free_, momentum_defect_, dv_;  // by position
  std::vector<ConeConstraint> cones_;
  std::vector<SoftRow> soft_rows_;
};

std::vector<std::uint32_t> InteriorPoint::number_movable(const ContactProblem& problem) {
  std::vector<std::uint32_t> number;
  std::uint32_t count = 0;
  for (const SolverBody& body : problem.bodies) number.push_back(body.inv_mass > 0.0 ? count++ : kImmovable);
  return number;
}

BlockPattern InteriorPoint::make_pattern(const ContactProblem& problem,
                                         const std::vector<std::uint32_t>& number) {
  std::vector<BlockPattern::Edge> edges;
  const auto add = [&](std::uint32_t a, std::uint32_t b) {
    if (a != b && number[a] != kImmovable && number[b] != kImmovable)
      edges.emplace_back(number[a], number[b]);
  };
  for (const PointContact& c : problem.contacts) add(c.a, c.b);
  for (const ScalarRow& row : problem.rows) add(row.a, row.b);
  const auto movable =
      number.size() - static_cast<std::size_t>(std::count(number.begin(), number.end(), kImmovable));
  return BlockPattern(static_cast<std::uint32_t>(movable), edges);
}

InteriorPoint::InteriorPoint(ContactProblem& problem, double tolerance, BestImpulses& best)
    : problem_(problem),
      tolerance_(tolerance),
      best_(best),
      number_(number_movable(problem)),
      matrix_(make_pattern(problem, number_)) {
  const BlockPattern& pattern = matrix_.pattern();
  mass_.assign(pattern.size(), Mat6::Zero());
  free_.resize(pattern.size());
  for (std::size_t i = 0; i < problem.bodies.size(); ++i) {
    if (number_[i] == kImmovable) continue;
    const SolverBody& body = problem.bodies[i];
    const std::uint32_t position = pattern.position(number_[i]);
    mass_[position].topLeftCorner<3, 3>() = Vec3::Constant(1.0 / body.inv_mass).asDiagonal();
    mass_[position].bottomRightCorner<3, 3>() = body.inv_I_W.inverse();
    free_[position] << body.v, body.w;
  }
  v_ = dv_ = momentum_defect_ = free_;
  cones_.reserve(problem.contacts.size() + problem.rows.size());
  for (PointContact& c : problem.contacts) {
    if (c.mass_n > 0.0) add_contact(c);
  }
  for (ScalarRow& row : problem.rows) {
    if (row.mass > 0.0) add_row(row);
  }
}

bool InteriorPoint::join(std::uint32_t a, std::uint32_t b, Joined& joined) const {
  const BlockPattern& pattern = matrix_.pattern();
  const auto position = [&](std::uint32_t i) {
    return number_[i] == kImmovable ? kImmovable : pattern.position(number_[i]);
  };
  const std::uint32_t pA = position(a), pB = position(b);
  joined.body[0] = std::min(pA, pB);
  joined.body[1] = std::max(pA, pB);
  if (joined.body[1] != kImmovable) joined.block = pattern.block(pA, pB);
  return pA > pB;
}

Vec3 InteriorPoint::immovable_velocity(std::uint32_t a, std::uint32_t b, const Vec3& rA,
                                       const Vec3& rB) const {
  const SolverBody &A = problem_.bodies[a], &B = problem_.bodies[b];
  Vec3 u = Vec3::Zero();
  if (number_[b] == kImmovable) u += B.v + B.w.cross(rB);
  if (number_[a] == kImmovable) u -= A.v + A.w.cross(rA);
  return u;
}

void InteriorPoint::add_contact(PointContact& c) {
  ConeConstraint& cone = cones_.emplace_back();
  const bool swapped = join(c.a, c.b, cone.joined);
  const bool rubs = c.friction > kFrictionless;
  cone.friction = rubs ? c.friction : 1.0;
  Mat3 frame = Mat3::Zero();  // the scaled directions
  frame.col(0) = c.n / cone.friction;
  if (rubs) {
    frame.col(1) = c.t1;
    frame.col(2) = c.t2;
  }
  Mat36 &JA = cone.J[swapped ? 1 : 0], &JB = cone.J[swapped ? 0 : 1];
  for (int i = 0; i < 3; ++i) {
    JA.row(i) = jacobian_row(frame.col(i), c.rA, -1.0).transpose();
    JB.row(i) = jacobian_row(frame.col(i), c.rB, 1.0).transpose();
  }
  const Vec3 u = immovable_velocity(c.a, c.b, c.rA, c.rB);
  cone.offset = Vec3(u.dot(frame.col(0)), u.dot(frame.col(1)), u.dot(frame.col(2)));
  cone.bound = c.bound / cone.friction;
  cone.mass_n = c.mass_n;
  cone.contact = &c.lambda;
}

void InteriorPoint::add_row(ScalarRow& row) {
  Joined joined;
  const bool swapped = join(row.a, row.b, joined);
  const Vec6 JA = jacobian_row(row.n, row.rA, -1.0), JB = jacobian_row(row.n, row.rB, 1.0);
  const Vec6 &J0 = swapped ? JB : JA, &J1 = swapped ? JA : JB;
  const double u = row.n.dot(immovable_velocity(row.a, row.b, row.rA, row.rB));
  if (!row.is_soft() && row.lower == 0.0) {
    ConeConstraint& cone = cones_.emplace_back();
    cone.joined = joined;
    cone.J[0].setZero();
    cone.J[1].setZero();
    cone.J[0].row(0) = J0.transpose();
    cone.J[1].row(0) = J1.transpose();
    cone.offset = Vec3(u, 0.0, 0.0);
    cone.bound = row.bound;
    cone.friction = 1.0;
    cone.mass_n = row.mass;
    cone.row = &row.lambda;
    return;
  }
  SoftRow& soft = soft_rows_.emplace_back();
  soft.joined = joined;
  soft.J[0] = J0;
  soft.J[1] = J1;
  soft.spring = row.is_soft();
  soft.softness = soft.spring ? row.softness : kTieStiffness * row.mass;
  soft.bias = u + (soft.spring ? row.bias : -row.bound);
  soft.row = &row.lambda;
  soft.lambda = 0.0;
}

Vec3 InteriorPoint::velocity(const ConeConstraint& cone, const std::vector<Vec6>& v) const {
  Vec3 u = cone.J[0] * v[cone.joined.body[0]];
  if (cone.joined.body[1] != kImmovable) u += cone.J[1] * v[cone.joined.body[1]];
  return u;
}

double InteriorPoint::velocity(const SoftRow& row, const std::vector<Vec6>& v) const {
  const double u = row.J[0].dot(v[row.joined.body[0]]);
  return row.joined.body[1] == kImmovable ? u : u + row.J[1].dot(v[row.joined.body[1]]);
}

void InteriorPoint::start() {
  double fastest = 0.0;
  for (const ConeConstraint& cone : cones_)
    fastest = std::max(fastest, (velocity(cone, v_) + cone.offset).norm());
  const double inside = std::max(1e-3, 0.3 * fastest);  // [m/s]
  for (ConeConstraint& cone : cones_) {
    cone.s = velocity(cone, v_) + cone.offset;
    const double tail = std::sqrt(cone.s.y() * cone.s.y() + cone.s.z() * cone.s.z());
    cone.s.x() = std::max(cone.s.x() - cone.bound, tail + inside);
    cone.z = Vec3(2.0 * inside * cone.mass_n, 0.0, 0.0);
  }
}

/// momentum_defect = M (v - v*) - J^T (z, lambda); gap = J v + c - s.
void InteriorPoint::update_defects() {
  for (std::size_t i = 0; i < v_.size(); ++i) momentum_defect_[i] = mass_[i] * (v_[i] - free_[i]);
  for (ConeConstraint& cone : cones_) {
    cone.gap = velocity(cone, v_) + cone.offset;
    cone.gap.x() += std::sqrt(cone.gap.y() * cone.gap.y() + cone.gap.z() * cone.gap.z()) - cone.bound;
    cone.gap -= cone.s;
    for (int k = 0; k < 2; ++k) {
      if (cone.joined.body[k] != kImmovable) {
        momentum_defect_[cone.joined.body[k]] -= cone.J[k].transpose() * cone.z;
      }
    }
  }
  for (SoftRow& row : soft_rows_) {
    row.defect = row.softness * (velocity(row, v_) + row.bias) + (row.spring ? row.lambda : 0.0);
    for (int k = 0; k < 2; ++k) {
      if (row.joined.body[k] != kImmovable) momentum_defect_[row.joined.body[k]] -= row.lambda * row.J[k];
    }
  }
}

/// H = M + J^T W^-2 J + J_soft^T softness J_soft.
bool InteriorPoint::factorize() {
  matrix_.set_zero();
  for (std::uint32_t i = 0; i < mass_.size(); ++i) matrix_.diagonal(i) = mass_[i];
  for (ConeConstraint& cone : cones_) {
    cone.scaling = make_cone_scaling(cone.s, cone.z);
    const Mat36 first = cone.scaling.inverse_square * cone.J[0];
    matrix_.diagonal(cone.joined.body[0]) += cone.J[0].transpose() * first;
    if (cone.joined.body[1] == kImmovable) continue;
    const Mat36 second = cone.scaling.inverse_square * cone.J[1];
    matrix_.diagonal(cone.joined.body[1]) += cone.J[1].transpose() * second;
    matrix_.below(cone.joined.block) += cone.J[1].transpose() * first;
  }
  for (const SoftRow& row : soft_rows_) {
    const Vec6 first = row.softness * row.J[0];
    matrix_.diagonal(row.joined.body[0]) += row.J[0] * first.transpose();
    if (row.joined.body[1] == kImmovable) continue;
    matrix_.diagonal(row.joined.body[1]) += row.softness * row.J[1] * row.J[1].transpose();
    matrix_.below(row.joined.block) += row.J[1] * first.transpose();
  }
  return matrix_.factorize();
}

/// dv, ds, dz for the `target` of every cone: H dv = -defect + J^T W^-2 (W target - gap), dz = W^-2 (W target - ds).
void InteriorPoint::find_direction() {
  for (std::size_t i = 0; i < dv_.size(); ++i) dv_[i] = -momentum_defect_[i];
  for (ConeConstraint& cone : cones_) {
    cone.dz = cone.scaling.W * cone.target;
    const Vec3 push = cone.scaling.inverse_square * (cone.dz - cone.gap);
    for (int k = 0; k < 2; ++k) {
      if (cone.joined.body[k] != kImmovable) dv_[cone.joined.body[k]] += cone.J[k].transpose() * push;
    }
  }
  for (const SoftRow& row : soft_rows_) {
    for (int k = 0; k < 2; ++k) {
      if (row.joined.body[k] != kImmovable) dv_[row.joined.body[k]] -= row.defect * row.J[k];
    }
  }
  matrix_.solve(dv_);
  for (ConeConstraint& cone : cones_) {
    cone.ds = velocity(cone, dv_) + cone.gap;
    cone.dz = cone.scaling.inverse_square * (cone.dz - cone.ds);
  }
  for (SoftRow& row : soft_rows_) row.change = -row.defect - row.softness * velocity(row, dv_);
}

double InteriorPoint::step_length() const {
  double step = kInfinity;
  for (const ConeConstraint& cone : cones_)
    step = std::min({step, cone_step(cone.s, cone.ds), cone_step(cone.z, cone.dz)});
  return step;
}

/// Mehrotra: a step towards the solution itself tells how much centring the second direction of this matrix gets.
void InteriorPoint::predict_and_correct() {
  double complementarity = 0.0;
  for (ConeConstraint& cone : cones_) {
    complementarity += cone.s.dot(cone.z);
    cone.target = -cone.scaling.l;
  }
  find_direction();
  const double step = std::min(1.0, step_length());
  double predicted = 0.0;
  for (const ConeConstraint& cone : cones_)
    predicted += (cone.s + step * cone.ds).dot(cone.z + step * cone.dz);
  const double ratio = predicted / complementarity;
  const double centring = std::clamp(ratio * ratio * ratio, 1e-6, 1.0);
  const double mean = complementarity / static_cast<double>(cones_.size());
  for (ConeConstraint& cone : cones_) {
    const ConeScaling& scaling = cone.scaling;
    const Vec3 second_order =
        cone_product(scaling.inverse_square * (scaling.W * cone.ds), scaling.W * cone.dz);
    const Vec3 wanted = Vec3(centring * mean, 0.0, 0.0) - cone_product(scaling.l, scaling.l) - second_order;
    cone.target = cone_divide(wanted, scaling.l);
  }
  find_direction();
}

void InteriorPoint::advance(double step) {
  for (std::size_t i = 0; i < v_.size(); ++i) v_[i] += step * dv_[i];
  for (ConeConstraint& cone : cones_) {
    cone.s += step * cone.ds;
    cone.z += step * cone.dz;
  }
  for (SoftRow& row : soft_rows_) row.lambda += step * row.change;
}

void InteriorPoint::store() {
  for (const ConeConstraint& cone : cones_) {
    if (cone.contact) {
      *cone.contact = Vec3(cone.z.x() / cone.friction, cone.z.y(), cone.z.z());
    } else {
      *cone.row = cone.z.x();
    }
  }
  for (const SoftRow& row : soft_rows_) *row.row = row.lambda;
}

int InteriorPoint::solve() {
  start();
  double least = kInfinity;
  int iterations = 0, stalls = 0;
  while (iterations < kMaxIterations && stalls < kMaxStalls) {
    update_defects();
    if (!factorize()) break;
    ++iterations;
    predict_and_correct();
    advance(std::min(1.0, kToBoundary * step_length()));
    store();
    const double residual = best_.offer();
    if (residual < tolerance_ || !(residual < kInfinity)) break;
    stalls = residual < 0.8 * least ? 0 : stalls + 1;
    least = std::min(least, residual);
  }
  return iterations;
}

}  // namespace

InteriorPointReport solve_interior_point(ContactProblem& problem, double tolerance, BestImpulses& best) {
  best.restore_start();
  return {.iterations = InteriorPoint(problem, tolerance, best).solve()};
}

}  // namespace tumble
