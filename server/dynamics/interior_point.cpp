// See interior_point.h. With J' = J whose normal row is divided by mu and z = (mu l_n, l_t), the Coulomb problem is
//   M (v - v*) = J'^T z,   s = J' v + c(v),   s in L, z in L, s o z = 0,   c = (|u_t| - b/mu, 0, 0)  (De Saxce),
// solved by Mehrotra's predictor and corrector in Nesterov-Todd scaling with c renewed in every iteration (Acary,
// Brogliato, Melanz 2023; Alizadeh, Goldfarb 2003). Rows without friction have J' = J in the first row, zeros below.
#include "dynamics/interior_point.h"

#include <algorithm>
#include <cmath>

#include "dynamics/lorentz_cone.h"

namespace tumble {
namespace {

constexpr int kMaxIterations = 40;  // a wall of 210 bodies needs 7, a mass ratio of 1e6 25
constexpr int kMaxStalls = 20;
constexpr double kLongStep = 0.3;  // takes so much of the defects along
constexpr double kToBoundary = 0.99;
/// Rigid two-sided rows are springs whose rest length follows the impulse (method of multipliers): this many times
/// stiffer than the row's own mass, so each iteration leaves a millionth of the error.
constexpr double kTieStiffness = 1e6;

struct ConeConstraint {
  Coupling joins;           // its frame scaled
  double bound;             // b/mu
  double friction, mass_n;  // friction 1 and one-dimensional where there is none
  Vec3* contact = nullptr;  // where the impulse goes: one of the two
  double* row = nullptr;
  Vec3 s, z, ds, dz, target, gap, sliding;
  ConeScaling scaling;
};

/// lambda = -softness (u + bias): a spring, or a two-sided rigid row in the limit of the iterations.
struct SoftRow {
  Coupling joins;
  double softness, bias;
  bool spring;
  double* row;
  double lambda, defect, change;
};

class InteriorPoint {
 public:
  InteriorPoint(ContactProblem& problem, VelocitySystem& system, double tolerance, BestImpulses& best);
  int solve();

 private:
  void add_contact(PointContact& c);
  void add_row(ScalarRow& row);

  void start();
  /// With the offset.
  Vec3 velocity(const Coupling& joins) const { return system_.velocity(joins, v_) + joins.offset; }
  void update_defects();
  bool factorize();
  void find_direction();
  double step_length() const;
  double complementarity() const;
  void predict_and_correct();
  void advance(double step);
  void store();

  VelocitySystem& system_;
  const double tolerance_;
  BestImpulses& best_;
  std::vector<Vec6> v_, free_, momentum_defect_, dv_;  // by position
  std::vector<ConeConstraint> cones_;
  std::vector<SoftRow> soft_rows_;
};

InteriorPoint::InteriorPoint(ContactProblem& problem, VelocitySystem& system, double tolerance,
                             BestImpulses& best)
    : system_(system), tolerance_(tolerance), best_(best) {
  system.load_velocities(free_);
  v_ = dv_ = momentum_defect_ = free_;
  cones_.reserve(problem.contacts.size() + problem.rows.size());
  for (PointContact& c : problem.contacts) {
    if (c.mass_n > 0.0) add_contact(c);
  }
  for (ScalarRow& row : problem.rows) {
    if (row.mass > 0.0) add_row(row);
  }
}

void InteriorPoint::add_contact(PointContact& c) {
  ConeConstraint& cone = cones_.emplace_back();
  cone.joins = system_.make_coupling(c);
  const bool rubs = c.friction > kFrictionless;
  cone.friction = rubs ? c.friction : 1.0;
  cone.joins.D.row(0) /= cone.friction;
  cone.joins.offset.x() /= cone.friction;
  if (!rubs) {
    cone.joins.D.bottomRows<2>().setZero();
    cone.joins.offset.tail<2>().setZero();
  }
  cone.bound = c.bound / cone.friction;
  cone.mass_n = c.mass_n;
  cone.contact = &c.lambda;
}

void InteriorPoint::add_row(ScalarRow& row) {
  if (!row.is_soft() && !row.is_two_sided()) {
    ConeConstraint& cone = cones_.emplace_back();
    cone.joins = system_.make_coupling(row);
    cone.bound = row.bound;
    cone.friction = 1.0;
    cone.mass_n = row.mass;
    cone.row = &row.lambda;
    return;
  }
  SoftRow& soft = soft_rows_.emplace_back();
  soft.joins = system_.make_coupling(row);
  soft.spring = row.is_soft();
  soft.softness = soft.spring ? row.softness : kTieStiffness * row.mass;
  soft.bias = soft.spring ? row.bias : -row.bound;
  soft.row = &row.lambda;
  soft.lambda = 0.0;
}

void InteriorPoint::start() {
  double fastest = 0.0;
  for (const ConeConstraint& cone : cones_) fastest = std::max(fastest, velocity(cone.joins).norm());
  const double inside = std::max(1e-3, 0.3 * fastest);  // [m/s]
  for (ConeConstraint& cone : cones_) {
    cone.s = velocity(cone.joins);
    const double tail = std::sqrt(cone.s.y() * cone.s.y() + cone.s.z() * cone.s.z());
    cone.s.x() = std::max(cone.s.x() - cone.bound, tail + inside);
    cone.z = Vec3(2.0 * inside * cone.mass_n, 0.0, 0.0);
  }
}

/// momentum_defect = M (v - v*) - J^T (z, lambda); gap = J v + c - s.
void InteriorPoint::update_defects() {
  for (Vec6& sum : momentum_defect_) sum.setZero();
  for (ConeConstraint& cone : cones_) {
    cone.gap = velocity(cone.joins);
    const double speed = std::sqrt(cone.gap.y() * cone.gap.y() + cone.gap.z() * cone.gap.z());
    cone.sliding = speed > 0.0 ? Vec3(0.0, cone.gap.y() / speed, cone.gap.z() / speed) : Vec3(Vec3::Zero());
    cone.gap.x() += speed - cone.bound;
    cone.gap -= cone.s;
    system_.add_impulse(cone.joins, cone.z, momentum_defect_);
  }
  for (SoftRow& row : soft_rows_) {
    row.defect = row.softness * (velocity(row.joins).x() + row.bias) + (row.spring ? row.lambda : 0.0);
    system_.add_impulse(row.joins, Vec3(row.lambda, 0.0, 0.0), momentum_defect_);
  }
  for (std::size_t i = 0; i < v_.size(); ++i)
    momentum_defect_[i] = system_.momentum(i, v_[i] - free_[i]) - momentum_defect_[i];
}

/// H = M + J^T W^-2 (1 + e0 sliding^T) J + J_soft^T softness J_soft: the shift |u_t| is linearized with the rest.
bool InteriorPoint::factorize() {
  system_.set_mass();
  for (ConeConstraint& cone : cones_) {
    cone.scaling = make_cone_scaling(cone.s, cone.z);
    Mat3 G = cone.scaling.inverse_square;
    G += cone.scaling.inverse_square.col(0) * cone.sliding.transpose();
    system_.add_stiffness(cone.joins, G);
  }
  for (const SoftRow& row : soft_rows_) {
    Mat3 G = Mat3::Zero();
    G(0, 0) = row.softness;
    system_.add_stiffness(row.joins, G);
  }
  return system_.factorize();
}

/// dv, ds, dz for the `target` of every cone: H dv = -defect + J^T W^-2 (W target - gap), dz = W^-2 (W target - ds).
void InteriorPoint::find_direction() {
  for (std::size_t i = 0; i < dv_.size(); ++i) dv_[i] = -momentum_defect_[i];
  for (ConeConstraint& cone : cones_) {
    cone.dz = cone.scaling.W * cone.target;
    system_.add_impulse(cone.joins, cone.scaling.inverse_square * (cone.dz - cone.gap), dv_);
  }
  for (const SoftRow& row : soft_rows_) system_.add_impulse(row.joins, Vec3(-row.defect, 0.0, 0.0), dv_);
  system_.solve(dv_);
  for (ConeConstraint& cone : cones_) {
    cone.ds = system_.velocity(cone.joins, dv_);
    cone.ds.x() += cone.sliding.dot(cone.ds);
    cone.ds += cone.gap;
    cone.dz = cone.scaling.inverse_square * (cone.dz - cone.ds);
  }
  for (SoftRow& row : soft_rows_)
    row.change = -row.defect - row.softness * system_.velocity(row.joins, dv_).x();
}

double InteriorPoint::step_length() const {
  double step = kInfinity;
  for (const ConeConstraint& cone : cones_)
    step = std::min({step, cone_step(cone.s, cone.ds), cone_step(cone.z, cone.dz)});
  return step;
}

double InteriorPoint::complementarity() const {
  double sum = 0.0;
  for (const ConeConstraint& cone : cones_) sum += cone.s.dot(cone.z);
  return sum;
}

/// Mehrotra: a step towards the solution itself tells how much centring the second direction of this matrix gets.
void InteriorPoint::predict_and_correct() {
  const double complementarity = this->complementarity();
  for (ConeConstraint& cone : cones_) cone.target = -cone.scaling.l;
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
  double least = kInfinity, least_left = kInfinity;
  int iterations = 0, stalls = 0;
  while (iterations < kMaxIterations && stalls < kMaxStalls) {
    update_defects();
    if (!factorize()) break;
    ++iterations;
    predict_and_correct();
    const double step = std::min(1.0, kToBoundary * step_length());
    advance(step);
    store();
    const double residual = best_.offer();
    if (residual < tolerance_ || !(residual < kInfinity)) break;
    // Where light bodies carry heavy ones, impulses have far to grow before products s . z and residuals fall.
    const double left = complementarity();
    stalls = residual < 0.8 * least || left < 0.8 * least_left || step > kLongStep ? 0 : stalls + 1;
    least = std::min(least, residual);
    least_left = std::min(least_left, left);
  }
  return iterations;
}

}  // namespace

int run_interior_point(ContactProblem& problem, VelocitySystem& system, double tolerance,
                       BestImpulses& best) {
  best.restore_start();
  apply_stored_moments(problem);  // of turnings, which stay as they are here: Newton's method moves them
  return InteriorPoint(problem, system, tolerance, best).solve();
}

}  // namespace tumble
