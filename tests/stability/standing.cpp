// Columns and walls of boxes: what is put up stands where it was put, at any mass ratio, and comes to rest.
#include <cmath>

#include "stability/case.h"
#include "support/standing_scenes.h"

namespace tumble::stability {
namespace {

using namespace test;

constexpr double kStill = 1e-6;  // [m] bound of drift and penetration of what the law of contact holds

std::vector<double> heavy_top(double mass) {
  std::vector<double> masses(10, 1.0);
  masses.back() = mass;
  return masses;
}

std::vector<double> geometric() {  // 1 to 1000 kg upwards
  std::vector<double> masses;
  for (int i = 0; i < 10; ++i) masses.push_back(std::pow(10.0, i / 3.0));
  return masses;
}

/// Put up without gaps.
Case placed_column(const std::string& name, const std::string& what, const std::vector<double>& masses) {
  const auto act = [masses](Trial& trial) {
    trial.begin(cube_stack(trial.options(), masses));
    trial.expect("time to rest [s]", trial.run_to_rest(0.6), 0.5);
    trial.run(trial.lasting(10.0, 60.0));
    trial.expect("drift [m]", trial.drift(), kStill);
    trial.expect("penetration [m]", trial.deepest(), kStill);
  };
  return {name, what + " stand, at rest within 0.5 s, drift and penetration <= 1e-6 m", precise(), act};
}

/// From 1 cm above the ground and 1.5 cm above each other, tilted. After the fall nothing moves any more. A column of ten is
/// a tower, which rocks from edge to edge and keeps 98 % of its speed at each: short steps and the finest accuracy see that
/// for seconds.
Case dropped_column(const std::string& name, const std::string& what, const std::vector<double>& masses) {
  const auto act = [masses](Trial& trial) {
    constexpr double kPatience = 5.0, kRocking = 0.05;  // [s], [m] of the top
    trial.begin(cube_stack(trial.options(), masses, {.height = 0.01, .gap = 0.015, .tilt = 0.01}));
    const double time = trial.run_to_rest(kPatience);
    const bool sees_rocks = trial.way().time_step < 0.01 || trial.way().accuracy == Accuracy::exact;
    if (!sees_rocks) trial.expect("time to rest [s]", time, 0.5);
    trial.expect("penetration [m]", trial.deepest_now(), kStill);
    trial.expect("way of the fall [m]", trial.drift(), 0.2);
    trial.begin(World(trial.world()));
    trial.run(trial.lasting(5.0, 60.0));
    trial.expect("drift from then on [m]", trial.drift(), time < kPatience ? 0.0 : kRocking);
  };
  return {name,
          what +
              ", dropped by 1 cm with tilts of 0.01 rad, stand, and stay to the bit once at rest: within 0.5 "
              "s at 1/60 s",
          precise(), act};
}

void column_stands(Trial& trial) {
  trial.begin(cube_stack(trial.options(), std::vector<double>(10, 1.0)));
  trial.run(trial.lasting(10.0, 60.0));
  trial.expect("drift [m]", trial.drift(), 0.1);
}

/// The same with every step solved: nothing is skipped at rest.
void column_awake(Trial& trial) {
  for (const double top : {1.0, 1e3, 1e6}) {
    Options options = trial.options();
    options.skip_resting = false;
    trial.begin(cube_stack(options, heavy_top(top)));
    trial.run(trial.lasting(2.0, 10.0));
    trial.expect("drift [m]", trial.drift(), kStill);
  }
}

void column_of_50(Trial& trial) {
  trial.begin(cube_stack(trial.options(), std::vector<double>(50, 1.0)));
  trial.run(trial.lasting(10.0, 60.0));
  trial.expect("drift [m]", trial.drift(), kStill);
}

void small_wall(Trial& trial) {
  trial.begin(cube_pyramid(trial.options(), 6, {.height = 0.01, .gap = 0.01}));
  trial.expect("time to rest [s]", trial.run_to_rest(5.0), 2.0);
  trial.expect("penetration [m]", trial.deepest_now(), 1e-4);
}

void large_wall(Trial& trial) {
  trial.begin(cube_pyramid(trial.options(), 20));
  trial.run(trial.lasting(2.0, 10.0));
  trial.expect("drift [m]", trial.drift(), 1e-3);
  trial.expect("penetration [m]", trial.deepest_now(), 0.75e-3);
}

void large_wall_stands(Trial& trial) {
  trial.begin(cube_pyramid(trial.options(), 20));
  trial.run(trial.lasting(2.0, 10.0));
  trial.expect("drift [m]", trial.drift(), 0.1);
  trial.expect("penetration [m]", trial.deepest_now(), 0.01);
}

/// Box2D's high mass ratio 1: heavy tops come down by half a metre on light walls.
void heavy_tops(Trial& trial) {
  World world(trial.options());
  world.create_body(ground());
  for (int k = 0; k < 3; ++k) {
    const Vec3 foot(20.0 * k, 0, 0);
    add_cube_pyramid(world, 9, {}, {.foot = foot}, "wall" + std::to_string(k) + "_");
    world.create_body(body_of_mass("top" + std::to_string(k), Box{Vec3(1, 0.5, 0.5)}, 200.0 * (k + 1),
                                   foot + Vec3(4.2, 0, 10.0)));
  }
  trial.begin(std::move(world));
  trial.run(trial.lasting(3.0, 10.0));
  trial.expect("drift [m]", trial.drift(), 0.55);
  trial.expect("speed at the end [m/s]", trial.fastest_now(), 1e-3);
}

/// Box2D's high mass ratio 2, in three dimensions: a cube of 10 m on four of 1 m, a thousand times lighter.
void big_on_small(Trial& trial) {
  World world(trial.options());
  world.create_body(ground());
  for (int i = 0; i < 4; ++i) {
    const Vec3 place(i % 2 == 0 ? 4.0 : -4.0, i < 2 ? 4.0 : -4.0, 0.5);
    world.create_body(body("foot" + std::to_string(i), Box{Vec3(0.5, 0.5, 0.5)}, place));
  }
  world.create_body(body("big", Box{Vec3(5, 5, 5)}, Vec3(0, 0, 6.01)));
  trial.begin(std::move(world));
  trial.run(trial.lasting(5.0, 60.0));
  trial.expect("drift [m]", trial.drift(), 0.0101);
  trial.expect("penetration [m]", trial.deepest_now(), kStill);
}

/// Faces, edges and corners coincide exactly.
void aligned_grid(Trial& trial) {
  World world(trial.options());
  world.create_body(ground());
  for (int i = 0; i < 27; ++i) {
    const Vec3 place(i % 3, i / 3 % 3, i / 9 + 0.5);
    world.create_body(body_of_mass("cube" + std::to_string(i), Box{Vec3(0.5, 0.5, 0.5)}, 1.0, place));
  }
  trial.begin(std::move(world));
  trial.run(trial.lasting(5.0, 60.0));
  trial.expect("drift [m]", trial.drift(), kStill);
}

void an_hour(Trial& trial) {
  trial.begin(cube_stack(trial.options(), heavy_top(1e3)));
  trial.run(1.0);
  trial.begin(World(trial.world()));
  trial.run(trial.lasting(60.0, 3600.0));
  trial.expect("drift [m]", trial.drift(), 0.0);
}

}  // namespace

std::vector<Case> standing_cases() {
  const std::vector<double> equal(10, 1.0);
  const std::string top_1e3 = "Ten cubes, the top one 1000 times heavier",
                    top_1e6 = "Ten cubes, the top one a million times heavier",
                    rising = "Ten cubes of 1 to 1000 kg upwards";
  return {
      placed_column("column", "Ten equal cubes", equal),
      placed_column("column_1e3", top_1e3, heavy_top(1e3)),
      placed_column("column_1e6", top_1e6, heavy_top(1e6)),
      placed_column("column_geometric", rising, geometric()),
      dropped_column("dropped", "Ten equal cubes", equal),
      dropped_column("dropped_1e3", top_1e3, heavy_top(1e3)),
      dropped_column("dropped_1e6", top_1e6, heavy_top(1e6)),
      dropped_column("dropped_geometric", rising, geometric()),
      {"column_stands", "Ten equal cubes stand: drift <= 10 cm", engines(), column_stands},
      {"column_awake", "Ten cubes, top 1 to 1e6 kg, never skipped at rest: drift <= 1e-6 m", precise(),
       column_awake},
      {"column_50", "Fifty cubes stand: drift <= 1e-6 m", precise(), column_of_50},
      {"wall_6", "A wall of 21 cubes, dropped row by row, at rest within 2 s", precise(), small_wall},
      {"wall_20",
       "The wall of 210 cubes: drift <= 1 mm, penetration <= 0.75 mm",
       {{Solver::exact}},
       large_wall,
       false,
       true},
      {"wall_20_stands", "The wall of 210 cubes stands: drift <= 10 cm, penetration <= 1 cm", sturdy(),
       large_wall_stands, false, true},
      {"heavy_tops",
       "Tops of 200, 400 and 600 kg come down by 0.5 m on walls of 45 cubes of 1 kg and lie still", precise(),
       heavy_tops, false, true},
      {"big_on_small", "A cube of 10 m on four of 1 m stands: penetration <= 1e-6 m", precise(),
       big_on_small},
      {"aligned", "27 cubes, faces and edges flush, stand: drift <= 1e-6 m", precise(), aligned_grid},
      {"hour", "A column at rest does not move by a bit in an hour", precise(), an_hour},
  };
}

}  // namespace tumble::stability
