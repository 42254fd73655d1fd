// Extreme numbers: spins, thickness, inertia, mass, size, place and step.
#include <cmath>

#include "stability/case.h"
#include "support/impact_scenes.h"
#include "support/standing_scenes.h"

namespace tumble::stability {
namespace {

using namespace test;

/// Free flight of one body: spin energy and angular momentum of the first body at the end, relative to the start.
void expect_free(Trial& trial, const BodyDefinition& definition, double seconds) {
  Options options = trial.options();
  options.gravity.setZero();
  World world(options);
  world.create_body(definition);
  trial.begin(std::move(world));
  const Conserved before = trial.world().compute_conserved();
  trial.run(seconds);
  const Conserved after = trial.world().compute_conserved();
  trial.expect("energy change", std::abs(after.kinetic_energy / before.kinetic_energy - 1.0), 1e-11);
  trial.expect("angular momentum change",
               (after.angular_momentum - before.angular_momentum).norm() / before.angular_momentum.norm(),
               1e-13);
}

void spinning_rod(Trial& trial) {
  BodyDefinition rod = body("rod", Box{Vec3(0.5, 0.0005, 0.0005)}, Vec3::Zero());
  rod.w_WB = Vec3(600, 500, -624);  // 1000 rad/s
  expect_free(trial, rod, trial.lasting(1.0, 10.0));
}

/// The same rod comes down on the floor.
void rod_on_floor(Trial& trial) {
  World world(trial.options());
  world.create_body(ground());
  BodyDefinition rod = body("rod", Box{Vec3(0.5, 0.0005, 0.0005)}, Vec3(0, 0, 0.7));
  rod.w_WB = Vec3(100, 1000, 100);
  world.create_body(rod);
  trial.begin(std::move(world));
  trial.run(trial.lasting(3.0, 20.0));
  trial.expect("energy gain", trial.energy_gain(), 1e-6);
}

void thin_plate(Trial& trial) {
  World world(trial.options());
  world.create_body(ground());
  const Box plate{Vec3(0.5, 0.5, 5e-7)};
  world.create_body(body("flat", plate, Vec3(0, 0, 5e-7)));
  BodyDefinition tilted = body("tilted", plate, Vec3(3, 0, 1));
  tilted.X_WL.q = exp_map(Vec3(0.3, 0.2, 0));
  world.create_body(tilted);
  trial.begin(std::move(world));
  trial.run(trial.lasting(4.0, 20.0));
  trial.expect("energy gain", trial.energy_gain(), 1e-3);
  trial.expect("drift of the flat one [m]", (trial.world().motion(1).x - Vec3(0, 0, 5e-7)).norm(), 1e-8);
  trial.expect("height at the end [m]", trial.world().motion(2).x.z(), 1e-4);
  trial.expect("speed at the end [m/s]", trial.fastest_now(), 1e-6);
}

/// I1 + I2 = I3 exactly, and all but nothing about one axis.
void flat_inertia(Trial& trial) {
  for (const Vec3& moments : {Vec3(1, 2, 3), Vec3(1e-9, 1, 1), Vec3(1, 1, 2)}) {
    BodyDefinition flat = body("flat", Sphere{0.1}, Vec3::Zero());
    flat.inertia = Inertia{1.0, Vec3::Zero(), moments.asDiagonal()};
    flat.w_WB = Vec3(1, 2, 3);
    expect_free(trial, flat, trial.lasting(5.0, 100.0));
  }
}

/// A crowd of 1e-6 to 1e9 kg, the light ones thrown at the heavy.
void masses(Trial& trial) {
  Options options = trial.options();
  options.gravity.setZero();
  World world(options);
  Dice dice(3);
  const Material material{.friction = 0.3, .restitution = 0.5};
  for (int i = 0; i < 32; ++i) {
    const double mass = std::pow(10.0, -6 + i / 2);
    BodyDefinition ball =
        body("ball" + std::to_string(i), Sphere{0.4}, Vec3(i % 4, i / 4 % 4, i / 16), material);
    ball.inertia = Inertia{mass, Vec3::Zero(), 0.4 * 0.16 * mass * Mat3::Identity()};
    ball.v_WB = 10.0 * dice.vector() - Vec3(5, 5, 5);
    world.create_body(ball);
  }
  trial.begin(std::move(world));
  trial.run(trial.lasting(2.0, 10.0));
  trial.expect("energy gain", trial.energy_gain(), 1e-9);
  trial.expect("momentum change", trial.momentum_change(), 1e-12);
}

void feather_and_anvil(Trial& trial) {
  World world(trial.options());
  world.create_body(ground());
  const Box cube{Vec3(0.5, 0.5, 0.5)};
  world.create_body(body_of_mass("anvil", cube, 1e9, Vec3(0, 0, 0.5)));
  world.create_body(body_of_mass("feather", cube, 1e-6, Vec3(0, 0, 1.5)));
  world.create_body(body_of_mass("feather under", cube, 1e-6, Vec3(3, 0, 0.5)));
  world.create_body(body_of_mass("weight", cube, 1.0, Vec3(3, 0, 1.5)));
  trial.begin(std::move(world));
  trial.run(trial.lasting(5.0, 20.0));
  trial.expect("drift [m]", trial.drift(), 1e-6);
}

/// Scaled cubes stand and rest like those of a metre.
void sizes(Trial& trial) {
  for (const double size : {1e-3, 1e3}) {
    const std::vector<double> masses(5, 1000.0 * size * size * size);
    trial.begin(cube_stack(trial.options(), masses, {}, {.size = size}));
    trial.run(trial.lasting(3.0, 20.0));
    trial.expect("drift / size", trial.drift() / size, 1e-6);
    trial.expect_true("at rest", trial.world().report().bodies_awake == 0);
  }
}

void tiny_wall(Trial& trial) {
  trial.begin(cube_pyramid(trial.options(), 6, {.height = 1e-4, .gap = 1e-4}, {.size = 0.01}));
  trial.run(trial.lasting(3.0, 20.0));
  trial.expect("drift / size", trial.drift() / 0.01, 0.07);
  trial.expect("speed at the end [m/s]", trial.fastest_now(), 1e-6);
}

/// 1e7 m away a double has 2e-9 m.
void far_away(Trial& trial) {
  const std::vector<double> masses(5, 1.0);
  trial.begin(cube_stack(trial.options(), masses, {}, {.foot = Vec3(1e7, -1e7, 1e7)}));
  trial.run(trial.lasting(10.0, 60.0));
  trial.expect("drift [m]", trial.drift(), 1e-6);
  trial.begin(
      cube_pyramid(trial.options(), 5, {.height = 0.01, .gap = 0.01}, {.foot = Vec3(-1e7, 1e7, 1e7)}));
  trial.run(trial.lasting(5.0, 60.0));
  trial.expect("drift of the wall [m]", trial.drift(), 0.06);
  trial.expect("speed at the end [m/s]", trial.fastest_now(), 1e-6);
}

/// The same column at every step from 10 us to 0.1 s.
void steps(Trial& trial) {
  for (const double step : {1e-5, 1e-4, 1e-3, 1.0 / 60.0, 1.0 / 30.0, 0.1}) {
    Options options = trial.options();
    options.time_step = step;
    trial.begin(cube_stack(options, std::vector<double>(5, 1.0), {.height = 1e-3, .gap = 1e-3}));
    trial.run(step < 1e-4 ? trial.lasting(0.2, 2.0) : trial.lasting(3.0, 60.0));
    trial.expect("drift at " + describe_step(step) + " [m]", trial.drift(), 0.006);
    trial.expect("penetration at " + describe_step(step) + " [m]", trial.deepest_now(), 1e-6);
  }
}

/// A step of another length every time, from 10 us to 0.1 s: a column stands, a stone flies its parabola.
void changing_steps(Trial& trial) {
  World world = cube_stack(trial.options(), std::vector<double>(5, 1.0), {.height = 1e-3, .gap = 1e-3});
  BodyDefinition stone = body("stone", Box{Vec3(0.3, 0.2, 0.1)}, Vec3(50, 0, 1000));
  stone.v_WB = Vec3(1, 2, 30);
  stone.w_WB = Vec3(1, 5, 0.1);
  const BodyId id = world.create_body(stone);
  trial.begin(std::move(world));
  Dice dice(7);
  trial.run(trial.lasting(8.0, 20.0),
            [&](World& now) { now.set_time_step(std::pow(10.0, -1.0 - 4.0 * dice())); });
  const World& end = trial.world();
  const double t = end.time();
  const Vec3 expected = Vec3(50, 0, 1000) + t * Vec3(1, 2, 30) + 0.5 * t * t * end.options().gravity;
  trial.expect("parabola [m]", (end.motion(id.index).x - expected).norm(), 1e-9);
  double drift = 0.0;
  for (std::uint32_t slot = 1; slot < id.index; ++slot) {
    drift = std::max(drift, std::abs(end.motion(slot).x.z() - (slot - 0.5)));
  }
  trial.expect("column's height [m]", drift, 1e-6);
}

}  // namespace

std::vector<Case> extreme_cases() {
  return {
      {"rod", "A rod of 1:1000 at 1000 rad/s keeps energy and angular momentum", everyone(), spinning_rod},
      {"rod_on_floor", "The same rod falls on the floor: energy never rises by 1e-6", precise(),
       rod_on_floor},
      {"plate", "Plates of 1e-6 m lie still, and come to lie from a fall", precise(1.0 / 240.0), thin_plate},
      {"inertia", "Moments at the limit of the triangle inequality: free spin keeps energy and momentum",
       everyone(), flat_inertia},
      {"masses", "Balls of 1e-6 to 1e9 kg collide: momentum kept, no energy gained", engines(), masses},
      {"feather", "1e-6 kg on 1e9 kg, and under 1 kg: drift <= 1e-6 m", precise(1.0 / 240.0),
       feather_and_anvil},
      {"sizes", "Columns of cubes of 1 mm and 1 km stand: drift <= 1e-6 of their size", precise(), sizes},
      {"tiny_wall", "A wall of cubes of 1 cm, dropped, lies still", precise(), tiny_wall},
      {"far", "1e7 m from the origin a column and a wall stand", precise(), far_away},
      {"steps", "A column stands at every step from 1e-5 to 0.1 s", precise(), steps, true, true},
      {"changing_steps",
       "At a step that changes between 1e-5 and 0.1 s a column stands, and flight stays exact", precise(),
       changing_steps, true},
  };
}

}  // namespace tumble::stability
