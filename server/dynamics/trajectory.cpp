// See trajectory.h.
#include "dynamics/trajectory.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tumble {
namespace {

/// Largest square of component k of w on the polhode: the other two components are traded for it by one of the two
/// invariants sum I_i (I_i - I_j) w_i^2 = const, which leaves out axis j.
double largest_square(const Vec3& I, const Vec3& w, int k) {
  double largest = kInfinity;
  for (const int j : {(k + 1) % 3, (k + 2) % 3}) {
    const int i = 3 - j - k;
    const double own = I[k] * (I[k] - I[j]), other = I[i] * (I[i] - I[j]);
    // Of one sign: w_k is largest where w_i is 0. Of opposite signs: this invariant does not bound it.
    if (own != 0.0 && other / own >= 0.0) {
      largest = std::min(largest, w[k] * w[k] + other / own * (w[i] * w[i]));
    }
  }
  const double energy = I.cwiseProduct(w).dot(w);
  return std::min(largest, energy / I[k]);
}

}  // namespace

RotationBound compute_rotation_bound(const MassProperties& mass, const Motion& motion, double torque,
                                     double time) {
  const Vec3 w_P = (motion.q * mass.q_BP).conjugate() * motion.w;
  const Vec3& I = mass.I;
  Vec3 w;
  if (torque == 0.0) {
    for (int k = 0; k < 3; ++k) w[k] = std::sqrt(largest_square(I, w_P, k));
  } else {
    w = (std::sqrt(motion.L.squaredNorm()) + torque * time) * mass.inv_I;
  }
  const Vec3 w_rate(std::abs(I.y() - I.z()) * w.y() * w.z(), std::abs(I.z() - I.x()) * w.z() * w.x(),
                    std::abs(I.x() - I.y()) * w.x() * w.y());
  // Rounding of the poses and of w itself must not break the bound.
  constexpr double kMore = 1.0 + 1e-9;
  const double square = w.squaredNorm();
  return {.speed = kMore * std::sqrt(square),
          .rate = kMore * (square + std::sqrt(mass.inv_I.cwiseProduct(w_rate).squaredNorm()) +
                           torque * mass.inv_I.maxCoeff())};
}

Trajectory Trajectory::driven(const Motion& start, double begin) {
  Trajectory trajectory;
  trajectory.start_ = start;
  trajectory.begin_ = begin;
  trajectory.kind_ = start.v.isZero(0.0) && start.w.isZero(0.0) ? Kind::stays : Kind::driven;
  const double w = std::sqrt(start.w.squaredNorm());
  trajectory.rotation_ = {.speed = w, .rate = w * w};
  return trajectory;
}

Trajectory::Trajectory(const MassProperties& mass, const Motion& start, double begin, double end,
                       const Motion& at_end, IntegrateFunction integrate)
    : Trajectory(mass, start, begin, end,
                 VelocityPath{.v0 = start.v, .v1 = at_end.v, .L0 = start.L, .L1 = at_end.L}, integrate,
                 at_end.x - start.x - 0.5 * (end - begin) * (start.v + at_end.v)) {
  at_end_ = at_end;
}

Trajectory::Trajectory(const MassProperties& mass, const Motion& start, double begin, const Flight& flight,
                       double flown)
    : start_(start),
      begin_(begin),
      kind_(Kind::flies),
      flight_(flight),
      flown_(flown),
      acceleration_(flight.load().acceleration),
      rotation_(compute_rotation_bound(mass, start, 0.0, 0.0)) {}

Trajectory::Trajectory(const MassProperties& mass, const Motion& start, double begin, double end,
                       const VelocityPath& drift, IntegrateFunction integrate, const Vec3& shift,
                       const Vec3& turn)
    : start_(start),
      begin_(begin),
      end_(end),
      kind_(Kind::drifts),
      mass_(&mass),
      integrate_(integrate),
      drift_(drift),
      momenta_{start.v, drift.v1, start.L, drift.L1},
      shift_(shift),
      turn_(turn) {
  const double span = end - begin;
  if (span > 0.0) {
    acceleration_ = (drift.v1 - drift.v0) / span;
    torque_ = (drift.L1 - drift.L0) / span;
    shift_ /= span;
    turn_ /= span;
  }
  Motion drifting = start;
  drifting.L = drift.L0;
  drifting.w = angular_velocity(mass, start.q, drift.L0);
  rotation_ = compute_rotation_bound(mass, drifting, std::sqrt(torque_.squaredNorm()), span);
  const double extra = std::sqrt(turn_.squaredNorm());
  rotation_.speed += extra;
  rotation_.rate += extra * (2.0 * rotation_.speed + extra);
}

Vec3 Trajectory::position(double t) const {
  const double s = t - begin_;
  switch (kind_) {
    case Kind::stays:
      return start_.x;
    case Kind::driven:
      return start_.x + s * start_.v;
    case Kind::flies:
      return flight_.position(flown_ + s);
    case Kind::drifts:
      break;
  }
  return start_.x + s * (drift_.v0 + (0.5 * s) * acceleration_ + shift_);
}

Vec3 Trajectory::velocity(double t) const {
  const double s = t - begin_;
  switch (kind_) {
    case Kind::stays:
    case Kind::driven:
      return start_.v;
    case Kind::flies:
      return flight_.velocity(flown_ + s);
    case Kind::drifts:
      break;
  }
  return drift_.v0 + s * acceleration_ + shift_;
}

Motion Trajectory::drift_at(double t) const {
  Motion motion = start_;
  const double s = t - begin_;
  switch (kind_) {
    case Kind::stays:
      return motion;
    case Kind::driven:
      move_kinematic(motion, s);
      return motion;
    case Kind::flies:
      return flight_.at(flown_ + s);
    case Kind::drifts:
      break;
  }
  VelocityPath path = drift_;
  if (t != end_) {
    path.v1 = path.v0 + s * acceleration_;
    path.L1 = path.L0 + s * torque_;
  }
  if (s > 0.0) {
    integrate_(*mass_, path, s, motion);
  } else {
    set_end_of_step(*mass_, path, motion.q, motion);
  }
  motion.x += s * shift_;
  if (!turn_.isZero(0.0)) {
    motion.q = normalized(exp_map(s * turn_) * motion.q);
    motion.w = angular_velocity(*mass_, motion.q, motion.L);
  }
  return motion;
}

Motion Trajectory::at(double t) const {
  if (t == begin_) return start_;
  if (t == end_ && at_end_) return *at_end_;
  Motion motion = drift_at(t);
  if (kind_ != Kind::drifts || t == end_) return motion;
  const double share = (t - begin_) / (end_ - begin_);
  motion.v = momenta_.v0 + share * (momenta_.v1 - momenta_.v0);
  motion.L = momenta_.L0 + share * (momenta_.L1 - momenta_.L0);
  motion.w = angular_velocity(*mass_, motion.q, motion.L);
  return motion;
}

}  // namespace tumble
