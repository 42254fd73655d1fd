// See smooth_motion.h. Three stages at c = 1/2, 1/2 -+ sqrt(15)/10; their slopes are found by fixed-point iteration, which
// gains about a digit a round at the sub-steps taken.
#include "dynamics/smooth_motion.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tumble {
namespace {

constexpr double kTurnAngle = 0.05, kSpringAngle = 0.1;  // [rad] a sub-step
constexpr double kMostSubSteps = 32.0;
constexpr int kMostRounds = 40;
constexpr double kCollocated = 1e-15, kGoodEnough = 1e-12;  // relative change of the stages in a round

constexpr std::size_t kStages = SmoothSystem::kStages;
constexpr double kRoot = 3.87298334620741688518;  // sqrt(15)
constexpr std::array<double, kStages> kTime = {0.5 - kRoot / 10.0, 0.5, 0.5 + kRoot / 10.0};
constexpr std::array<double, kStages> kWeight = {5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0};
constexpr std::array<std::array<double, kStages>, kStages> kStage = {
    {{5.0 / 36.0, 2.0 / 9.0 - kRoot / 15.0, 5.0 / 36.0 - kRoot / 30.0},
     {5.0 / 36.0 + kRoot / 24.0, 2.0 / 9.0, 5.0 / 36.0 - kRoot / 24.0},
     {5.0 / 36.0 + kRoot / 30.0, 2.0 / 9.0 + kRoot / 15.0, 5.0 / 36.0}}};

using Slope = SmoothSystem::Slope;
using Place = SmoothSystem::Place;
using Slopes = std::vector<Slope>;

/// A dynamic body at y0 + h sum a_j k_j, or one with given velocities after `time`.
Place stage_place(const SmoothBody& body, const std::array<Slopes, kStages>& slopes, std::size_t index,
                  const std::array<double, kStages>& weights, double h, double time) {
  const Motion& start = body.motion;
  Place place{start.x, start.v, start.w, start.L, start.q.coeffs(), Mat3::Identity()};
  if (body.type != BodyType::dynamic) {
    place.x += time * start.v;
    place.q = (exp_map(time * start.w) * start.q).coeffs();
    place.R_WB = rotation_matrix(normalized(Quat(place.q)));
    return place;
  }
  for (std::size_t j = 0; j < kStages; ++j) {
    const Slope& k = slopes[j][index];
    const double a = h * weights[j];
    place.x += a * k.x;
    place.v += a * k.v;
    place.L += a * k.L;
    place.q += a * k.q;
  }
  const Quat q = normalized(Quat(place.q));
  place.R_WB = rotation_matrix(q);
  place.w = angular_velocity(body.mass, q, place.L);
  return place;
}

void add_spring(const SmoothSpring& tie, const std::vector<Place>& places, std::vector<Vec3>& forces,
                std::vector<Vec3>& torques) {
  const Place &A = places[tie.a], &B = places[tie.b];
  const Vec3 rA = A.R_WB * tie.pA, rB = B.R_WB * tie.pB;
  const Vec3 line = B.x + rB - A.x - rA;
  const double length = line.norm();
  if (!(length > 0.0)) return;  // it has no direction
  const Vec3 n = line / length;
  const double rate = n.dot(B.v + B.w.cross(rB) - A.v - A.w.cross(rA));
  const Vec3 pull = spring_tension(tie.spring, length, rate) * n;
  forces[tie.a] += pull;
  torques[tie.a] += rA.cross(pull);
  forces[tie.b] -= pull;
  torques[tie.b] -= rB.cross(pull);
}

class Stepper {
 public:
  explicit Stepper(SmoothSystem& system)
      : system_(system),
        slopes_(system.scratch.slopes),
        places_(system.scratch.places),
        forces_(system.scratch.forces),
        torques_(system.scratch.torques) {
    for (Slopes& slopes : slopes_) slopes.resize(system.bodies.size());
    places_.resize(system.bodies.size());
    forces_.resize(system.bodies.size());
    torques_.resize(system.bodies.size());
  }

  bool step(double h) {
    for (Slopes& slopes : slopes_) std::fill(slopes.begin(), slopes.end(), Slope{});
    double change = 0.0, before = 0.0;
    for (int round = 0; round < kMostRounds; ++round) {
      before = change;
      change = 0.0;
      for (std::size_t stage = 0; stage < kStages; ++stage) change = std::max(change, update_stage(stage, h));
      if (!std::isfinite(change)) return false;
      if (change <= kCollocated || (round > 0 && change <= kGoodEnough && change >= before)) {
        finish(h);
        return true;
      }
    }
    return false;
  }

 private:
  /// Slopes of one stage from the present slopes of all; returns the largest relative change.
  double update_stage(std::size_t stage, double h) {
    const std::size_t count = system_.bodies.size();
    for (std::size_t i = 0; i < count; ++i) {
      const SmoothBody& body = system_.bodies[i];
      places_[i] = stage_place(body, slopes_, i, kStage[stage], h, kTime[stage] * h);
      forces_[i] = body.load.force(places_[i].R_WB);
      torques_[i] = body.load.torque(places_[i].R_WB);
    }
    for (const SmoothSpring& spring : system_.springs) add_spring(spring, places_, forces_, torques_);
    double change = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const SmoothBody& body = system_.bodies[i];
      if (body.type != BodyType::dynamic) continue;
      const Place& place = places_[i];
      Slope& slope = slopes_[stage][i];
      const Slope old = slope;
      slope.x = place.v;
      slope.v = body.gravity + body.mass.inv_mass * forces_[i] - body.linear_damping * place.v;
      slope.L = torques_[i] - body.angular_damping * place.L;
      const Quat rate = Quat(0.0, place.w.x(), place.w.y(), place.w.z()) * Quat(place.q);
      slope.q = 0.5 * rate.coeffs();
      const auto relative = [h](const auto& now, const auto& then, double size) {
        const double change = h * (now - then).norm();
        return change == 0.0 ? 0.0 : change / (size + h * now.norm());
      };
      change = std::max({change, relative(slope.v, old.v, place.v.norm()),
                         relative(slope.L, old.L, place.L.norm()), relative(slope.q, old.q, 1.0)});
    }
    return change;
  }

  void finish(double h) {
    for (std::size_t i = 0; i < system_.bodies.size(); ++i) {
      SmoothBody& body = system_.bodies[i];
      const Place end = stage_place(body, slopes_, i, kWeight, h, h);
      body.motion.x = end.x;
      body.motion.q = normalized(Quat(end.q));
      if (body.type != BodyType::dynamic) continue;
      body.motion.v = end.v;
      body.motion.L = end.L;
      body.motion.w = end.w;
    }
  }

  SmoothSystem& system_;
  std::array<Slopes, kStages>& slopes_;
  std::vector<Place>& places_;
  std::vector<Vec3>&forces_, &torques_;
};

/// How fast things turn, swing and are damped [rad/s], in units of what a sub-step may hold.
double sub_steps_per_second(const SmoothSystem& system) {
  double most = 0.0;
  for (const SmoothBody& body : system.bodies) {
    if (body.type == BodyType::fixed) continue;
    most = std::max({most, body.motion.w.norm() / kTurnAngle, body.linear_damping / kSpringAngle,
                     body.angular_damping / kSpringAngle});
  }
  for (const SmoothSpring& tie : system.springs) {
    const auto give = [](const SmoothBody& body, const Vec3& p) {
      return body.type == BodyType::dynamic
                 ? body.mass.inv_mass + p.squaredNorm() * body.mass.inv_I.maxCoeff()
                 : 0.0;
    };
    const double inv_mass = give(system.bodies[tie.a], tie.pA) + give(system.bodies[tie.b], tie.pB);
    most = std::max({most, std::sqrt(tie.spring.stiffness * inv_mass) / kSpringAngle,
                     tie.spring.damping * inv_mass / kSpringAngle});
  }
  return most;
}

}  // namespace

bool advance_smoothly(SmoothSystem& system, double h) {
  const double steps = std::max(1.0, std::ceil(h * sub_steps_per_second(system)));
  if (!(steps <= kMostSubSteps)) return false;
  std::vector<Motion>& start = system.scratch.start;
  start.clear();
  for (const SmoothBody& body : system.bodies) start.push_back(body.motion);
  Stepper stepper(system);
  for (double i = 0.0; i < steps; i += 1.0) {
    if (stepper.step(h / steps)) continue;
    for (std::size_t k = 0; k < start.size(); ++k) system.bodies[k].motion = start[k];
    return false;
  }
  return true;
}

}  // namespace tumble
