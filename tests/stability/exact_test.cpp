// What stands under the exact solver does not move: stacks and pyramids through the whole world, at any mass ratio.
#include <gtest/gtest.h>

#include <cmath>

#include "support/world_builder.h"

namespace tumble {
namespace {

using namespace test;

const Box kCube{Vec3(0.5, 0.5, 0.5)};

Options exact_options(double time_step) {
  Options options;
  options.time_step = time_step;
  options.solver = Solver::exact;
  return options;
}

World stack(double time_step, double top_mass, bool rest = true, double gap = 0.0) {
  Options options = exact_options(time_step);
  options.skip_resting = rest;
  World world(options);
  world.create_body(ground());
  for (int i = 0; i < 10; ++i) {
    const double offset = i % 2 == 0 ? 0.01 : -0.01;
    const Vec3 x(offset, -0.5 * offset, 0.5 + i + gap * (i + 1));
    world.create_body(body_of_mass("box" + std::to_string(i), kCube, i == 9 ? top_mass : 1.0, x));
  }
  return world;
}

/// A wall of 21 cubes, every row `gap` above the one below.
World pyramid(double time_step, double gap) {
  World world(exact_options(time_step));
  world.create_body(ground());
  for (int row = 0; row < 6; ++row) {
    for (int i = 0; i + row < 6; ++i) {
      const Vec3 x(1.05 * i + 0.525 * row, 0, 0.5 + row + gap * (row + 1));
      world.create_body(body_of_mass("box" + std::to_string(10 * row + i), kCube, 1.0, x));
    }
  }
  return world;
}

/// Time until no body is awake, at most `limit` [s].
double time_to_rest(World& world, double limit) {
  const double h = world.options().time_step;
  double t = 0.0;
  do {
    world.step();
    t += h;
  } while (t < limit && world.report().bodies_awake > 0);
  return t;
}

class ExactStack : public ::testing::TestWithParam<std::tuple<double, double>> {};

TEST_P(ExactStack, DoesNotDriftIn600StepsWithoutRest) {
  const auto [rate, top] = GetParam();
  const World start = stack(1.0 / rate, top, false);
  World world = start;
  run(world, 600);
  EXPECT_LE(largest_displacement(start, world), 1e-6);  // measured 1e-10..2e-8
}

TEST_P(ExactStack, ComesToRestWhereItWasPut) {
  const auto [rate, top] = GetParam();
  const World start = stack(1.0 / rate, top);
  World world = start;
  EXPECT_LT(time_to_rest(world, 0.5), 0.1);
  run(world, static_cast<int>(10 * rate));
  EXPECT_LE(largest_displacement(start, world), 1e-8);
}

INSTANTIATE_TEST_SUITE_P(RatesAndTopMasses, ExactStack,
                         ::testing::Combine(::testing::Values(60.0, 240.0),
                                            ::testing::Values(1.0, 1e3, 1e6)));

TEST(Exact, ADroppedStackComesToRestInHalfASecond) {
  for (const double rate : {60.0, 240.0}) {
    World world = stack(1.0 / rate, 1.0, true, 1e-3);
    EXPECT_LT(time_to_rest(world, 2.0), 0.5) << rate;
    EXPECT_LE(world.report().deepest_penetration, 1e-6) << rate;
  }
}

TEST(Exact, ADroppedPyramidComesToRest) {
  for (const double rate : {60.0, 240.0}) {
    World world = pyramid(1.0 / rate, 0.01);
    EXPECT_LT(time_to_rest(world, 5.0), 2.0) << rate;
    EXPECT_LE(world.report().deepest_penetration, 1e-4) << rate;
  }
}

TEST(Exact, ABlockSlidesDownAnInclineByTheClosedForm) {
  const double slope = 0.5, friction = 0.3, t = 2.0;
  const double a = 9.81 * (std::sin(slope) - friction * std::cos(slope));
  for (const double heading : {0.0, 0.3, 1.1, 2.0}) {
    const Vec3 direction(std::cos(heading), std::sin(heading), 0.0);
    Options options = exact_options(1.0 / 240.0);
    options.gravity = 9.81 * (std::sin(slope) * direction - std::cos(slope) * Vec3::UnitZ());
    const Material material{.friction = friction};
    World world(options);
    world.create_body(ground(material));
    const BodyId id = world.create_body(body("block", Box{Vec3(0.5, 0.5, 0.25)}, Vec3(0, 0, 0.25), material));
    run(world, 480);
    const Motion& block = world.motion(id.index);
    EXPECT_LE((block.v - a * t * direction).norm(), 1e-6) << heading;
    EXPECT_LE((block.x - Vec3(0, 0, 0.25) - 0.5 * a * t * t * direction).norm(), 1e-6) << heading;
  }
}

}  // namespace
}  // namespace tumble
