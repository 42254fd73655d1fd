// See truth.h.
#include "error/truth.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "peers/peer.h"
#include "support/impact_scenes.h"
#include "support/rotation_reference.h"

namespace tumble::bench {
namespace {

/// Samples of a motion that is known at any time.
template <typename MotionAt>
Truth sample(const std::vector<Solid>& solids, double interval, std::size_t count, MotionAt motion_at) {
  Truth truth;
  for (std::size_t k = 0; k <= count; ++k) {
    std::vector<Motion>& motions = truth.samples.emplace_back();
    for (const Solid& solid : solids) motions.push_back(motion_at(solid, static_cast<double>(k) * interval));
  }
  return truth;
}

Quat turned(const Vec3& axis, double angle, const Quat& q) {
  return Quat(Eigen::AngleAxisd(angle, axis)) * q;
}

double ground_friction(const std::vector<Solid>& solids) {
  for (const Solid& solid : solids) {
    if (std::holds_alternative<HalfSpace>(solid.shape)) return solid.material.friction;
  }
  throw std::invalid_argument("a ground is needed");
}

Truth sample_steps(const Scene& scene, std::size_t bodies, double h, double interval, std::size_t count) {
  const std::vector<Method> methods = tumble_methods();
  const auto exact = std::ranges::find(methods, kExactLevel, &Method::name);
  const std::unique_ptr<Peer> peer = exact->make(scene, h);
  Truth truth;
  for (std::size_t k = 0; k <= count; ++k) {
    std::vector<Motion>& motions = truth.samples.emplace_back();
    for (std::size_t i = 0; i < bodies; ++i) motions.push_back(peer->motion(i));
    for (long step = std::lround(interval / h); step > 0; --step) peer->step();
  }
  return truth;
}

double radius_of(const Solid& ball) {
  return std::get<Sphere>(ball.shape).radius;
}

}  // namespace

Truth flying(const Scene& scene, double interval, std::size_t count) {
  const std::vector<Solid> dynamic = dynamic_of(solids_of(scene));
  const Vec3& gravity = scene.options.gravity;
  Truth truth;
  truth.samples.resize(count + 1);
  for (const Solid& solid : dynamic) {
    const Vec3 w_B = solid.X_WS.q.conjugate() * solid.w;
    test::RotationReference<> coarse(solid.mass.I, w_B), fine(solid.mass.I, w_B);
    for (std::size_t k = 0; k <= count; ++k) {
      const double t = static_cast<double>(k) * interval;
      Motion& motion = truth.samples[k].emplace_back();
      motion.x = solid.X_WS.p + t * solid.v + 0.5 * t * t * gravity;
      motion.v = solid.v + t * gravity;
      motion.q = solid.X_WS.q * fine.orientation();
      const Vec3 L = angular_momentum(solid.mass, solid.X_WS.q, solid.w);
      motion.w = angular_velocity(solid.mass, motion.q, L);
      truth.doubt = std::max(truth.doubt, bounding_radius(solid.shape) *
                                              fine.orientation().angularDistance(coarse.orientation()));
      coarse.advance(static_cast<long double>(interval), 0.3L);
      fine.advance(static_cast<long double>(interval), 0.2L);
    }
  }
  return truth;
}

Truth bouncing(const Scene& scene, double interval, std::size_t count) {
  return sample(dynamic_of(solids_of(scene)), interval, count,
                [g = -scene.options.gravity.z()](const Solid& ball, double t) {
                  const double radius = radius_of(ball);
                  const test::Bouncing now =
                      test::bouncing_at(ball.material.restitution, ball.X_WS.p.z() - radius, g, t);
                  Motion motion;
                  motion.x = Vec3(ball.X_WS.p.x(), ball.X_WS.p.y(), radius + now.height);
                  motion.v = Vec3(0, 0, now.speed);
                  motion.q = ball.X_WS.q;
                  return motion;
                });
}

Truth on_slope(const Scene& scene, double interval, std::size_t count) {
  const std::vector<Solid> solids = solids_of(scene);
  const Vec3& gravity = scene.options.gravity;
  const Vec3 along(gravity.x(), gravity.y(), 0.0), downhill = along.normalized();
  const double pull = along.norm(), press = -gravity.z(), mu_ground = ground_friction(solids);
  return sample(dynamic_of(solids), interval, count, [=](const Solid& solid, double t) {
    const bool ball = std::holds_alternative<Sphere>(solid.shape);
    const double mu = pair_friction(solid.material.friction, mu_ground);
    if (ball && mu * press < 2.0 / 7.0 * pull) throw std::invalid_argument("the ball would slide");
    const double a = ball ? 5.0 / 7.0 * pull : std::max(0.0, pull - mu * press);
    Motion motion;
    motion.x = solid.X_WS.p + 0.5 * a * t * t * downhill;
    motion.v = a * t * downhill;
    motion.q = solid.X_WS.q;
    if (ball) {
      const Vec3 axis = Vec3::UnitZ().cross(downhill);
      motion.q = turned(axis, 0.5 * a * t * t / radius_of(solid), motion.q);
      motion.w = a * t / radius_of(solid) * axis;
    }
    return motion;
  });
}

Truth sliding_to_roll(const Scene& scene, double interval, std::size_t count) {
  const std::vector<Solid> solids = solids_of(scene);
  const double g = -scene.options.gravity.z(), mu_ground = ground_friction(solids);
  return sample(dynamic_of(solids), interval, count, [=](const Solid& ball, double t) {
    const double r = radius_of(ball), a = g * pair_friction(ball.material.friction, mu_ground);
    const Vec3 slip = ball.v + r * Vec3::UnitZ().cross(ball.w), way = slip.normalized();
    const Vec3 axis = Vec3::UnitZ().cross(way);
    const double sliding = std::min(t, 2.0 / 7.0 * slip.norm() / a), rolling = t - sliding;
    Motion motion;
    motion.v = ball.v - a * sliding * way;
    motion.w = ball.w + 2.5 * a / r * sliding * axis;
    motion.x = ball.X_WS.p + sliding * ball.v - 0.5 * a * sliding * sliding * way + rolling * motion.v;
    const double angle =
        ball.w.dot(axis) * sliding + 1.25 * a / r * sliding * sliding + motion.w.dot(axis) * rolling;
    motion.q = turned(axis, angle, ball.X_WS.q);
    return motion;
  });
}

Truth dropped(const Scene& scene, double interval, std::size_t count) {
  const std::vector<Solid> dynamic = dynamic_of(solids_of(scene));
  double height = kInfinity;
  for (const Solid& solid : dynamic)
    height = std::min(height, compute_aabb(solid.shape, solid.X_WS).lower.z());
  return sample(dynamic, interval, count,
                [height, g = -scene.options.gravity.z()](const Solid& solid, double t) {
                  const double fall = std::min(0.5 * g * t * t, height);
                  Motion motion;
                  motion.x = solid.X_WS.p - Vec3(0, 0, fall);
                  motion.v = Vec3(0, 0, fall < height ? -g * t : 0.0);
                  motion.q = solid.X_WS.q;
                  return motion;
                });
}

Truth by_tiny_steps(const Scene& scene, double interval, std::size_t count) {
  const std::vector<Solid> solids = dynamic_of(solids_of(scene));
  Truth coarse = sample_steps(scene, solids.size(), 1.0 / 50000.0, interval, count);
  Truth fine = sample_steps(scene, solids.size(), 1.0 / 100000.0, interval, count);
  for (std::size_t k = 0; k <= count; ++k) {
    for (std::size_t i = 0; i < solids.size(); ++i) {
      fine.doubt = std::max(fine.doubt, distance(solids[i], coarse.samples[k][i], fine.samples[k][i]));
    }
  }
  return fine;
}

double distance(const Solid& solid, const Motion& motion, const Motion& truth) {
  const Quat turn = motion.q * truth.q.conjugate();  // |vector part| = sin(angle / 2)
  return (motion.x - truth.x).norm() + 2.0 * bounding_radius(solid.shape) * turn.vec().norm();
}

}  // namespace tumble::bench
