// Impacts under stress: elastic gases keep their energy, fast bodies pass through nothing, chains hand on what came in.
#include <cmath>

#include "stability/case.h"
#include "support/impact_scenes.h"

namespace tumble::stability {
namespace {

using namespace test;

void elastic_gas(Trial& trial) {
  trial.begin(gas(trial.extent(4, 8), trial.options()));
  trial.run(trial.lasting(1.0, 10.0));
  const double gain = trial.energy_gain();
  trial.expect("energy gain", gain, 1e-11);
  trial.expect("penetration [m]", trial.deepest(), 1e-9);
}

/// Up to 2000 bounces; the limit of their times is sqrt(2h/g) (1 + e) / (1 - e).
void bounces_to_rest(Trial& trial) {
  const double e = trial.extent(0.9, 0.99);
  const double end = std::sqrt(2.0 / 9.81) * (1.0 + e) / (1.0 - e);
  World world(trial.options());
  const Material lively{.restitution = e};
  world.create_body(ground(lively));
  world.create_body(body("ball", Sphere{0.1}, Vec3(0, 0, 1.1), lively));
  trial.begin(std::move(world));
  const double step = trial.way().time_step;
  trial.expect("time to rest - closed form [s]", std::abs(trial.run_to_rest(end + 5.0) - end),
               0.02 + 2.0 * step);
  trial.expect("energy gain", trial.energy_gain(), 1e-12);
}

void bullet(Trial& trial) {
  Options options = trial.options();
  options.gravity.setZero();
  World world(options);
  BodyDefinition wall = body("wall", Box{Vec3(0.0005, 5, 5)}, Vec3(20, 0, 0));
  wall.type = BodyType::fixed;
  world.create_body(wall);
  const Shape shapes[] = {Sphere{0.01}, Box{Vec3(0.01, 0.02, 0.03)}, Capsule{0.01, 0.02}};
  for (int i = 0; i < 3; ++i) {
    BodyDefinition bullet = body("bullet" + std::to_string(i), shapes[i], Vec3(0.37 * i, i - 1.0, 0));
    bullet.v_WB = Vec3(1000, 0, 0);
    bullet.w_WB = Vec3(10, 200, 30);
    world.create_body(bullet);
  }
  trial.begin(std::move(world));
  double farthest = 0.0;
  trial.run(0.3, [&](World& now) {
    for (std::uint32_t slot = 1; slot < 4; ++slot) farthest = std::max(farthest, now.motion(slot).x.x());
  });
  trial.expect("farthest [m]", farthest, 20.0);
}

void handed_on(Trial& trial) {
  trial.begin(cradle(1, 1e-9, 1.0, trial.options()));
  trial.run(1.0);
  const World& world = trial.world();
  for (std::uint32_t i = 0; i < 5; ++i) {
    trial.expect("speed error [m/s]", std::abs(world.motion(i).v.x() - (i == 4 ? 1.0 : 0.0)), 1e-9);
  }
}

void break_rack(Trial& trial) {
  trial.begin(billiard_break(trial.options(), 1e-3));
  const double before = trial.world().compute_conserved().kinetic_energy;
  trial.run(1.0);
  const double after = trial.world().compute_conserved().kinetic_energy;
  trial.expect("momentum change", trial.momentum_change(), 1e-12);
  trial.expect("energy change", std::abs(after / before - 1.0), 1e-11);
}

/// Both materials' corners: frictionless and all but glued, dead and perfectly elastic; thrown, spinning boxes.
void corner_materials(Trial& trial) {
  for (const double friction : {0.0, 1e3}) {
    for (const double restitution : {0.0, 1.0}) {
      const Material material{.friction = friction, .restitution = restitution};
      World world(trial.options());
      world.create_body(ground(material));
      Dice dice(5);
      for (int i = 0; i < 8; ++i) {
        BodyDefinition box =
            body("box" + std::to_string(i), Box{Vec3(0.3, 0.2, 0.1)}, Vec3(0.8 * i, 0, 1), material);
        box.v_WB = 4.0 * dice.vector() - Vec3(2, 2, 2);
        box.w_WB = 20.0 * dice.vector() - Vec3(10, 10, 10);
        world.create_body(box);
      }
      trial.begin(std::move(world));
      trial.run(trial.lasting(3.0, 10.0));
      trial.expect("energy gain", trial.energy_gain(), 1e-3);
    }
  }
}

/// Two kilometres an hour above a step's reach of each other: every ball flies at 300 m/s through a crowd.
void swarm(Trial& trial) {
  Options options = trial.options();
  options.gravity.setZero();
  World world(options);
  Dice dice(11);
  const Material elastic{.friction = 0.3, .restitution = 0.5};
  for (int i = 0; i < trial.extent(60, 200); ++i) {
    BodyDefinition ball =
        body_of_mass("ball" + std::to_string(i), Sphere{0.2}, 1.0, 10.0 * dice.vector(), elastic);
    ball.v_WB = 300.0 * (Vec3(5, 5, 5) - ball.X_WL.p).normalized();
    world.create_body(ball);
  }
  trial.begin(std::move(world));
  trial.run(0.5);
  trial.expect("energy gain", trial.energy_gain(), 1e-9);
  trial.expect("momentum change", trial.momentum_change(), 1e-10);
}

}  // namespace

std::vector<Case> impact_cases() {
  return {
      {"gas", "An elastic gas of balls keeps its energy to 1e-11 and nobody overlaps", engines(), elastic_gas,
       false, true},
      {"bounces", "A ball with C_r = 0.99 comes to rest in its time", precise(), bounces_to_rest},
      {"bullet", "At 1 km/s nothing passes through a wall of 1 mm", engines(), bullet},
      {"cradle", "A cradle with gaps of 1 nm hands on its ball to 1e-9 m/s", engines(), handed_on},
      {"break", "A break of 15 balls keeps momentum and energy", engines(), break_rack},
      {"materials", "mu = 0 and 1000, C_r = 0 and 1: energy never rises by 1e-3", sturdy(), corner_materials},
      {"swarm", "Balls that rush together at 300 m/s keep momentum and gain no energy", engines(), swarm,
       false, true},
  };
}

}  // namespace tumble::stability
