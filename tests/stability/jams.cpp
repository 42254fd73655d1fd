// Jams: contacts that hold each other, or that nothing can satisfy.
#include <cmath>

#include "stability/case.h"
#include "support/world_builder.h"

namespace tumble::stability {
namespace {

using namespace test;

/// Two fixed half-spaces that meet in the y axis, each `angle` [rad] from upright.
World wedge(const Options& options, double angle, const Material& material) {
  World world(options);
  for (const double side : {-1.0, 1.0}) {
    BodyDefinition wall = ground(material);
    wall.name = side < 0.0 ? "left" : "right";
    wall.X_WL.q = rotation_to_normal(Vec3(-side * std::cos(angle), 0, std::sin(angle)));
    world.create_body(wall);
  }
  return world;
}

/// Thrown into a narrow wedge; each side carries m g / (2 sin(angle)) without friction.
void ball_in_wedge(Trial& trial) {
  const double angle = 0.05, r = 0.1;
  World world = wedge(trial.options(), angle, {.friction = 0.0});
  const double seat = r / std::sin(angle);
  BodyDefinition ball = body("ball", Sphere{r}, Vec3(0.0, 0, seat + 1.0), {.friction = 0.0});
  ball.v_WB = Vec3(0, 0, -30);
  const BodyId id = world.create_body(ball);
  trial.begin(std::move(world));
  trial.run(trial.lasting(3.0, 60.0));
  trial.expect("energy gain", trial.energy_gain(), 1e-6);
  trial.expect("height - seat [m]", std::abs(trial.world().motion(id.index).x.z() - seat), 1e-4);
}

void box_in_wedge(Trial& trial) {
  for (const double friction : {0.3, 3.0}) {
    World world = wedge(trial.options(), 0.2, {.friction = friction});
    BodyDefinition box = body("box", Box{Vec3(0.2, 0.3, 0.1)}, Vec3(0.05, 0, 2), {.friction = friction});
    box.v_WB = Vec3(0, 0, -10);
    box.X_WL.q = exp_map(Vec3(0.2, 0.7, 0.1));
    world.create_body(box);
    trial.begin(std::move(world));
    trial.run(trial.lasting(3.0, 60.0));
    trial.expect("energy gain", trial.energy_gain(), 1e-3);
    trial.expect("penetration at the end [m]", trial.deepest_now(), 1e-3);
    trial.expect("speed at the end [m/s]", trial.fastest_now(), 1e-3);
  }
}

/// Painleve's rod: sliding with its lower end ahead and mu > 4/3 there is no finite force that keeps it on the floor.
void painleve(Trial& trial) {
  for (const double friction : {1.0, 1.4, 2.0, 10.0}) {
    for (const double lean : {0.3, 0.6, 0.9}) {  // [rad] from upright
      const Material rough{.friction = friction};
      World world(trial.options());
      world.create_body(ground(rough));
      const double half = 0.5, r = 0.01;
      BodyDefinition rod = body("rod", Capsule{r, half}, Vec3(0, 0, r + half * std::cos(lean)), rough);
      rod.X_WL.q = exp_map(Vec3(0, -lean, 0));
      rod.v_WB = Vec3(5, 0, 0);
      world.create_body(rod);
      trial.begin(std::move(world));
      trial.run(trial.lasting(3.0, 20.0));
      trial.expect("energy gain", trial.energy_gain(), 1e-3);
      trial.expect("penetration at the end [m]", trial.deepest_now(), 1e-3);
    }
  }
}

/// A press comes down on a cube, 20 cm farther than there is room, waits, and goes up again.
void press(Trial& trial) {
  World world(trial.options());
  world.create_body(ground());
  const BodyId cube = world.create_body(body("cube", Box{Vec3(0.5, 0.5, 0.5)}, Vec3(0, 0, 0.5)));
  BodyDefinition plate = body("press", Box{Vec3(1, 1, 0.1)}, Vec3(0, 0, 1.2));
  plate.type = BodyType::kinematic;
  plate.v_WB = Vec3(0, 0, -0.3);
  const BodyId id = world.create_body(plate);
  trial.begin(std::move(world));
  trial.run(1.0);
  World& now = trial.world();
  now.set_motion(id, now.link_pose(id.index), Vec3::Zero(), Vec3::Zero());
  trial.run(0.5);
  trial.expect("speed in the press [m/s]", trial.fastest_now(), 3.1);
  now.set_motion(id, now.link_pose(id.index), Vec3(0, 0, 1), Vec3::Zero());
  trial.run(2.0);
  trial.expect("way of the cube [m]", (now.motion(cube.index).x - Vec3(0, 0, 0.5)).norm(), 1e-2);
  trial.expect("speed at the end [m/s]", trial.fastest_now(), 1e-6);
}

/// Two presses from the sides: a row of cubes has nowhere to go.
void vice(Trial& trial) {
  World world(trial.options());
  world.create_body(ground());
  for (int i = 0; i < 3; ++i) {
    world.create_body(body("cube" + std::to_string(i), Box{Vec3(0.5, 0.5, 0.5)}, Vec3(i - 1.0, 0, 0.5)));
  }
  std::vector<BodyId> jaws;
  for (const double side : {-1.0, 1.0}) {
    BodyDefinition jaw = body(side < 0 ? "left" : "right", Box{Vec3(0.2, 1, 1)}, Vec3(1.8 * side, 0, 1.01));
    jaw.type = BodyType::kinematic;
    jaw.v_WB = Vec3(-0.2 * side, 0, 0);
    jaws.push_back(world.create_body(jaw));
  }
  trial.begin(std::move(world));
  trial.run(1.0);
  World& now = trial.world();
  for (const BodyId jaw : jaws) {
    const double side = now.motion(jaw.index).x.x() < 0.0 ? -1.0 : 1.0;
    now.set_motion(jaw, now.link_pose(jaw.index), Vec3(side, 0, 0), Vec3::Zero());
  }
  trial.run(3.0);
  trial.expect("speed at the end [m/s]", trial.fastest_now(), 1e-6);
  trial.expect("penetration at the end [m]", trial.deepest_now(), 1e-4);
}

}  // namespace

std::vector<Case> jam_cases() {
  return {
      {"wedge_ball",
       "A ball thrown at 30 m/s into a wedge of 6 degrees stays in its seat and gains no energy", nobody(),
       ball_in_wedge},
      {"wedge_box", "A box thrown into a wedge, mu = 0.3 and 3, jams or settles; energy never rises by 1e-3",
       precise(), box_in_wedge},
      {"painleve", "Painleve's rod, mu = 1 to 10: no gain of energy by 1e-3, no sinking in",
       sturdy(1.0 / 240.0), painleve},
      {"press", "A press that asks for the impossible lets the cube go where it found it", precise(), press},
      {"vice", "Three cubes between two jaws come free at rest", precise(), vice},
  };
}

}  // namespace tumble::stability
