// Scenes of impacts, in the sizes of the published benchmarks or smaller, for the tests and for ./run bench impacts.
#pragma once

#include <cmath>

#include "support/world_builder.h"

namespace tumble::test {

inline Options with_step(double time_step) {
  Options options;
  options.time_step = time_step;
  return options;
}

inline double total_energy(const World& world) {
  const Conserved sums = world.compute_conserved();
  return sums.kinetic_energy + sums.potential_energy;
}

/// Numbers in [0, 1) from a fixed linear congruence: the same scene everywhere.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed) {}
  double operator()() {
    state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<double>(state_ >> 11) * 0x1p-53;
  }
  Vec3 vector() {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return {x, y, z};
  }

 private:
  std::uint64_t state_;
};

/// SimBenchmark "bouncing": n x n balls of 0.1 m and 10 kg at 5 m over the ground, C_r = 1.
inline World bouncing(int n, double time_step) {
  const Material elastic{.friction = 0.0, .restitution = 1.0};
  World world(with_step(time_step));
  world.create_body(ground(elastic));
  for (int i = 0; i < n * n; ++i) {
    world.create_body(body_of_mass("ball" + std::to_string(i), Sphere{0.1}, 10.0,
                                   Vec3(2.0 * (i % n), 2.0 * (i / n), 5.0), elastic));
  }
  return world;
}

/// SimBenchmark "elastic 666": n x n x n balls of 0.1 m and 10 kg, 0.21 m apart up to 1 mm, from 1.101 m, C_r = 1.
inline World elastic_666(int n, double time_step) {
  const Material elastic{.friction = 0.0, .restitution = 1.0};
  World world(with_step(time_step));
  world.create_body(ground(elastic));
  Dice dice(42);
  for (int i = 0; i < n * n * n; ++i) {
    const Vec3 place = 0.21 * Vec3(i % n, i / n % n, i / (n * n)) + 0.001 * dice.vector() + Vec3(0, 0, 1.101);
    world.create_body(body_of_mass("ball" + std::to_string(i), Sphere{0.1}, 10.0, place, elastic));
  }
  return world;
}

/// n^3 balls of 0.08 m and 1 kg in a cube of six planes, 0.5 m apart, up to 3 m/s along each axis, C_r = 1.
inline World gas(int n, const Options& options) {
  const Material elastic{.friction = 0.0, .restitution = 1.0};
  World world(options);
  const double half = 0.25 * n;
  for (int k = 0; k < 6; ++k) {
    BodyDefinition wall = ground(elastic);
    wall.name = "wall" + std::to_string(k);
    Vec3 normal = Vec3::Zero();
    normal[k / 2] = k % 2 == 0 ? 1.0 : -1.0;
    wall.X_WL = {rotation_to_normal(normal), -half * normal};
    world.create_body(wall);
  }
  Dice dice(1);
  for (int i = 0; i < n * n * n; ++i) {
    const Vec3 place = 0.5 * Vec3(i % n, i / n % n, i / (n * n)) - Vec3::Constant(half - 0.25);
    BodyDefinition ball = body_of_mass("ball" + std::to_string(i), Sphere{0.08}, 1.0, place, elastic);
    ball.v_WB = 3.0 * (2.0 * dice.vector() - Vec3::Ones());
    world.create_body(ball);
  }
  return world;
}

/// A box of three different edges that falls on a plane without friction, turning about all its axes, C_r = 1.
inline World tumbling_box(double time_step) {
  const Material elastic{.friction = 0.0, .restitution = 1.0};
  World world(with_step(time_step));
  world.create_body(ground(elastic));
  BodyDefinition box = body("box", Box{Vec3(0.3, 0.2, 0.1)}, Vec3(0, 0, 1), elastic);
  box.v_WB = Vec3(0.5, 0.2, 0.0);
  box.w_WB = Vec3(3, 4, 5);
  world.create_body(box);
  return world;
}

/// Five balls of 1 m and 1 kg in a row, `gap` apart; the first `arriving` come from half a metre with 1 m/s.
inline World cradle(int arriving, double gap, double restitution, Options options) {
  const Material material{.friction = 0.0, .restitution = restitution};
  options.gravity.setZero();
  World world(options);
  for (int i = 0; i < 5; ++i) {
    const double x = i * (1.0 + gap) - (i < arriving ? 0.5 : 0.0);
    BodyDefinition ball = body_of_mass("ball" + std::to_string(i), Sphere{0.5}, 1.0, Vec3(x, 0, 0), material);
    if (i < arriving) ball.v_WB = Vec3(1, 0, 0);
    world.create_body(ball);
  }
  return world;
}

struct EnergyError {
  double mean_square = 0.0;  ///< [J^2] over the steps.
  double drift = 0.0;        ///< Largest, relative to the start.
  double overlap = 0.0;      ///< [m] deepest.
};

inline EnergyError measure_energy(World& world, double seconds) {
  const double start = total_energy(world);
  const int steps = static_cast<int>(std::lround(seconds / world.options().time_step));
  EnergyError error;
  for (int i = 0; i < steps; ++i) {
    world.step();
    const double difference = total_energy(world) - start;
    error.mean_square += difference * difference / steps;
    error.drift = std::max(error.drift, std::abs(difference / start));
    error.overlap = std::max(error.overlap, world.report().deepest_penetration);
  }
  return error;
}

/// Fifteen elastic billiard balls racked along x, touching, the cue ball on its way to them with 5 m/s, `offset` [m] beside
/// their axis; no gravity.
inline World billiard_break(Options options, double offset) {
  options.gravity.setZero();
  const Material elastic{.friction = 0.0, .restitution = 1.0};
  World world(options);
  const double r = 0.0286;  // [m]
  BodyDefinition cue = body_of_mass("cue", Sphere{r}, 0.17, Vec3(-0.5, offset, 0), elastic);
  cue.v_WB = Vec3(5, 0, 0);
  world.create_body(cue);
  for (int row = 0; row < 5; ++row) {
    for (int i = 0; i <= row; ++i) {
      const Vec3 place(std::sqrt(3.0) * r * row, r * (2 * i - row), 0);
      world.create_body(
          body_of_mass("ball" + std::to_string(row) + std::to_string(i), Sphere{r}, 0.17, place, elastic));
    }
  }
  return world;
}

/// A ball over the ground, as high as `height` [m] and rising at `speed` [m/s].
struct Bouncing {
  double height, speed;
};
/// At time t of a ball dropped at rest from `drop` [m], under gravity g [m/s^2], in long double.
inline Bouncing bouncing_at(double restitution, double drop, double gravity, double t) {
  const auto state = [](long double height, long double speed) {
    return Bouncing{static_cast<double>(height), static_cast<double>(speed)};
  };
  const long double g = gravity, fall = sqrtl(2.0L * drop / g);
  long double left = t - fall, v = g * fall * restitution;
  if (left < 0.0L) return state(drop - 0.5L * g * t * t, -g * t);
  for (int bounce = 0; bounce < 2000; ++bounce) {
    if (left < 2.0L * v / g) return state(v * left - 0.5L * g * left * left, v - g * left);
    left -= 2.0L * v / g;
    v *= restitution;
  }
  return {0.0, 0.0};
}

/// Height over the ground at time t of a ball dropped from 1 m at rest.
inline double bouncing_height(double restitution, double t) {
  return bouncing_at(restitution, 1.0, 9.81, t).height;
}

}  // namespace tumble::test
