// Inelastic contact takes energy and never gives any: boxes, hulls and balls that fall, rock, roll and slide on a plane, on
// a slab and across two slabs, alone and on top of each other. What pushes overlaps apart is work that the step reports.
#include <gtest/gtest.h>

#include <memory>

#include "support/impact_scenes.h"

namespace tumble {
namespace {

using namespace test;

Shape random_shape(Dice& dice) {
  const double kind = dice();
  if (kind < 0.1) return Sphere{0.1 + 0.2 * dice()};
  if (kind < 0.55) return Box{Vec3::Constant(0.1) + 0.4 * dice.vector()};
  std::vector<Vec3> points;
  const int count = 8 + static_cast<int>(12.0 * dice());
  for (int i = 0; i < count; ++i) {
    points.push_back(Vec3(0.4, 0.28, 0.2).cwiseProduct(2.0 * dice.vector() - Vec3::Ones()));
  }
  return std::make_shared<const ConvexHull>(build_convex_hull(points));
}

void add_floor(World& world, Dice& dice, const Material& material) {
  const int slabs = static_cast<int>(3.0 * dice());
  if (slabs == 0) world.create_body(ground(material));
  for (int i = 0; i < slabs; ++i) {
    BodyDefinition slab =
        body("slab" + std::to_string(i), Box{Vec3(0.3, 2, 0.1)}, Vec3(0.8 * i - 0.4, 0, -0.1), material);
    slab.type = BodyType::fixed;
    if (dice() < 0.3) slab.X_WL.q = exp_map(0.2 * (2.0 * dice.vector() - Vec3::Ones()));
    world.create_body(slab);
  }
}

/// One to three bodies above the floor, turning and drifting, some nearly level.
World random_scene(std::uint64_t seed, const Options& options, double friction) {
  Dice dice(seed);
  World world(options);
  const Material material{.friction = friction};
  add_floor(world, dice, material);
  const int count = 1 + static_cast<int>(3.0 * dice());
  for (int i = 0; i < count; ++i) {
    const Shape shape = random_shape(dice);
    const double x = 0.4 * dice() - 0.2, y = 0.4 * dice(), tilt = dice() < 0.5 ? 0.2 : 3.0;
    BodyDefinition falling = body("body" + std::to_string(i), shape, Vec3(x, y, 0.75 + 1.2 * i), material);
    falling.X_WL.q = exp_map(tilt * (2.0 * dice.vector() - Vec3::Ones()));
    falling.v_WB = 2.0 * dice.vector() - Vec3::Ones();
    falling.w_WB = 3.0 * (2.0 * dice.vector() - Vec3::Ones());
    world.create_body(falling);
  }
  return world;
}

/// What may lift the energy in a step: 1e-8 m of what presses on the floor, which is the slack of the drift; in a landing
/// the impulse of a step is many times the weight's [J].
double allowed_gain(const World& world) {
  double weight = 0.0;
  for (std::uint32_t slot = 0; slot < world.body_capacity(); ++slot) {
    weight += world.mass_properties(slot).mass * 9.81;
  }
  return 1e-7 * weight;
}

TEST(Energy, InelasticContactNeverGivesAny) {
  // Measured: at most 2.5e-8 m of weight in a step, with both accuracies and every step; before the drift was limited
  // 5e-4 m, and one scene in three gained.
  int steps = 0, touching = 0, unsolved = 0;
  for (const Accuracy accuracy : {Accuracy::balanced, Accuracy::exact}) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
      Dice dice(1000 + seed);
      Options options = with_step(kStepLengths[seed % 3]);
      set_accuracy(options, accuracy);
      World world = random_scene(seed, options, 1.2 * dice());
      const double allowed = allowed_gain(world);
      double energy = total_energy(world);
      for (; world.time() < 1.5; ++steps) {
        world.step();
        const double gain = total_energy(world) - energy;
        energy += gain;
        touching += world.report().contacts > 0;
        if (gain <= world.report().push_work + allowed) continue;
        // Bodies that jam between others: where no solution was found, none gives the energy.
        ++unsolved;
        ASSERT_GE(world.report().max_residual, 1e-3) << "scene " << seed << " step " << world.step_count();
      }
    }
  }
  EXPECT_GE(touching, steps / 2);
  EXPECT_LE(unsolved, 5);  // measured: 0
}

}  // namespace
}  // namespace tumble
