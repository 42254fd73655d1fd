// On the border of stick and slip: nothing creeps, and nothing rests that must slide.
#include <cmath>

#include "math/rotation.h"
#include "stability/case.h"
#include "support/gravity.h"
#include "support/world_builder.h"

namespace tumble::stability {
namespace {

using namespace test;

constexpr double kSlope = 0.4;  // [rad]

/// Runs a block on a plane with mu = tan(slope) + excess for so long; returns its way down.
double slide(Trial& trial, double excess, double seconds) {
  Options options = trial.options();
  options.gravity = kG * Vec3(std::sin(kSlope), 0, -std::cos(kSlope));
  const Material material{.friction = std::tan(kSlope) + excess};
  World world(options);
  world.create_body(ground(material));
  const BodyId block =
      world.create_body(body("block", Box{Vec3(0.5, 0.5, 0.25)}, Vec3(0, 0, 0.25), material));
  trial.begin(std::move(world));
  trial.run(seconds);
  return trial.world().motion(block.index).x.x();
}

void sticks(Trial& trial) {
  for (const double excess : {1e-2, 1e-4}) {
    trial.expect("way [m]", std::abs(slide(trial, excess, trial.lasting(10.0, 60.0))), 1e-9);
  }
}

void slides(Trial& trial) {
  for (const double lack : {1e-2, 1e-3, 1e-4}) {
    const double expected = 0.5 * kG * std::cos(kSlope) * lack * 100.0;
    trial.expect("way / closed form - 1", std::abs(slide(trial, -lack, 10.0) / expected - 1.0), 1e-6);
  }
}

/// Released on its edge, ten degrees from upright: it rocks, walks and comes to rest; friction and impact only take.
void rocks(Trial& trial) {
  World world(trial.options());
  world.create_body(ground());
  BodyDefinition block = body_of_mass("block", Box{Vec3(0.25, 0.25, 1.0)}, 1.0, Vec3(0, 0, 1.2));
  block.X_WL.q = exp_map(Vec3(0.05, 0.17, 0.02));
  world.create_body(block);
  trial.begin(std::move(world));
  trial.run(10.0);
  trial.expect("energy gain", trial.energy_gain(), 1e-3);
  trial.expect("speed at the end [m/s]", trial.fastest_now(), 1e-3);
}

/// A cube balanced on a corner, and one on an edge: unstable, so anything may happen but a gain of energy.
void balances(Trial& trial) {
  World world(trial.options());
  world.create_body(ground());
  BodyDefinition corner = body_of_mass("corner", Box{Vec3(0.5, 0.5, 0.5)}, 1.0, Vec3(0, 0, std::sqrt(0.75)));
  corner.X_WL.q = rotation_to_normal(Vec3(1, 1, 1).normalized()).conjugate();
  world.create_body(corner);
  BodyDefinition edge = body_of_mass("edge", Box{Vec3(0.5, 0.5, 0.5)}, 1.0, Vec3(5, 0, std::sqrt(0.5)));
  edge.X_WL.q = exp_map(Vec3(std::atan(1.0), 0, 0));
  world.create_body(edge);
  trial.begin(std::move(world));
  trial.run(trial.lasting(5.0, 60.0));
  trial.expect("energy gain", trial.energy_gain(), 1e-3);
}

}  // namespace

std::vector<Case> slope_cases() {
  return {
      {"sticks", "A block on a slope with mu = tan + 1e-4 does not creep: <= 1e-9 m in 10 s", precise(),
       sticks},
      {"slides", "With mu = tan - 1e-4 it slides by the closed form in 10 s: no false rest", precise(),
       slides},
      {"rocks", "A tall block dropped at a tilt rocks to rest; energy never rises by 1e-3", sturdy(), rocks},
      {"balances", "A cube on a corner and one on an edge: energy never rises by 1e-3", sturdy(), balances},
  };
}

}  // namespace tumble::stability
