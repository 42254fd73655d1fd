// Impacts through the whole engine, at three steps each: what is measured must not depend on the step. The full sizes and
// times of the benchmarks are run by ./run bench impacts. Measured values stand for 1/60 | 1/240 | 1/1000 s.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "support/impact_scenes.h"

namespace tumble {
namespace {

using namespace test;

TEST(Impact, AnElasticBallKeepsHeightAndEnergyForTenSeconds) {
  for (const double h : kStepLengths) {
    const Material elastic{.friction = 0.0, .restitution = 1.0};
    World world(with_step(h));
    world.create_body(ground(elastic));
    const BodyId ball = world.create_body(body("ball", Sphere{0.1}, Vec3(0, 0, 1.1), elastic));
    double height = 0.0, energy = 0.0;
    for (int i = 0; i < static_cast<int>(std::lround(10.0 / h)); ++i) {
      world.step();
      const Motion motion = world.motion(ball.index);
      height = std::max(height, std::abs(motion.x.z() - 0.1 - bouncing_height(1.0, world.time())));
      energy = std::max(energy, std::abs((0.5 * motion.v.squaredNorm() / 9.81 + motion.x.z() - 0.1) - 1.0));
    }
    EXPECT_LE(height, 1e-12) << h;  // 1.0e-14 | 3.9e-15 | 5.0e-15 m
    EXPECT_LE(energy, 1e-13) << h;  // 8.9e-16 | 4.4e-16 | 8.9e-16
    EXPECT_EQ(world.counters().impacts, 11u);
  }
}

TEST(Impact, ABallComesToRestInTheStepOfItsLastBounce) {
  const double end = std::sqrt(2.0 / 9.81) * 1.8 / 0.2;  // 4.0637 s
  for (const double h : kStepLengths) {
    const Material material{.friction = 0.0, .restitution = 0.8};
    World world(with_step(h));
    world.create_body(ground(material));
    const BodyId ball = world.create_body(body("ball", Sphere{0.1}, Vec3(0, 0, 1.1), material));
    double height = 0.0, last_moving = 0.0;
    while (world.time() < 5.0) {
      world.step();
      const Motion motion = world.motion(ball.index);
      height = std::max(height, std::abs(motion.x.z() - 0.1 - bouncing_height(0.8, world.time())));
      if (motion.v.norm() > 1e-9) last_moving = world.time();
    }
    EXPECT_LE(height, 1e-12) << h;  // 1.1e-15 | 1.1e-15 | 7.4e-16 m
    EXPECT_LT(last_moving, end) << h;
    EXPECT_GE(last_moving + h * (1.0 + 1e-9), end) << h;
    EXPECT_TRUE(world.resting(ball.index));
    EXPECT_EQ(world.counters().impacts_ended, 1u);
  }
}

TEST(Impact, BouncingBallsKeepTheirEnergy) {  // 9 of the 49 balls, 4 of the 20 s
  for (const double h : kStepLengths) {
    World world = bouncing(3, h);
    const EnergyError error = measure_energy(world, 4.0);
    EXPECT_LE(error.mean_square, 1e-12) << h;  // 3e-24 | 3e-24 | 4e-24 J^2
  }
}

TEST(Impact, ElasticGridKeepsItsEnergy) {  // 64 of the 216 balls, 1 of the 10 s
  for (const double h : kStepLengths) {
    World world = elastic_666(4, h);
    const EnergyError error = measure_energy(world, 1.0);
    EXPECT_LE(error.mean_square, 1e-6) << h;
    EXPECT_LE(error.overlap, 1e-12) << h;
    EXPECT_GT(world.counters().impacts, 200u);
  }
}

TEST(Impact, AGasKeepsItsEnergyAndNobodyOverlaps) {  // 125 of the 512 balls, 1 of the 10 s
  for (const double h : kStepLengths) {
    World world = gas(5, with_step(h));
    const EnergyError error = measure_energy(world, 1.0);
    EXPECT_LE(error.drift, 1e-13) << h;
    EXPECT_LE(error.overlap, 1e-12) << h;
    EXPECT_GT(world.counters().impacts, 300u);
    EXPECT_EQ(world.counters().impacts_capped, 0u);
  }
}

TEST(Impact, ATumblingBoxIsTheSameAtEveryStep) {
  std::vector<Motion> after_five;
  for (const double h : kStepLengths) {
    World world = tumbling_box(h);
    const double start = total_energy(world);
    double drift = 0.0;
    while (world.time() < 10.0) {
      world.step();
      drift = std::max(drift, std::abs(total_energy(world) / start - 1.0));
      if (std::abs(world.time() - 1.8) < 1e-9) {
        EXPECT_GE(world.counters().impacts, 5u);
        after_five.push_back(world.motion(1));
      }
    }
    EXPECT_LE(drift, 1e-12) << h;  // 2.0e-14 | 6.7e-15 | 2.1e-14
    // 12 poses looked at an impact at most, with all the returns in between.
    EXPECT_LE(world.counters().impact_looks, 12 * world.counters().impacts);
    EXPECT_EQ(world.counters().impact_searches_bounded, 0u);
  }
  ASSERT_EQ(after_five.size(), 3u);
  for (const Motion& motion : after_five) {
    EXPECT_LE((motion.x - after_five[0].x).norm(), 1e-9);  // 4e-13 m
    EXPECT_LE((motion.v - after_five[0].v).norm(), 1e-9);
    EXPECT_LE(1.0 - std::abs(motion.q.dot(after_five[0].q)), 1e-15);
  }
}

TEST(Impact, InACradleAsManyLeaveAsArrive) {
  for (const double h : kStepLengths) {
    for (const double gap : {0.0, 1e-9}) {
      for (int arriving = 1; arriving <= 4; ++arriving) {
        World world = cradle(arriving, gap, 1.0, with_step(h));
        run(world, static_cast<int>(std::lround(1.0 / h)));
        for (std::uint32_t i = 0; i < 5; ++i) {
          const double expected = i < 5u - static_cast<unsigned>(arriving) ? 0.0 : 1.0;
          EXPECT_NEAR(world.motion(i).v.x(), expected, 1e-13) << h << " " << gap << " " << arriving;
        }
        EXPECT_NEAR(world.compute_conserved().momentum.x(), arriving, 1e-14);
      }
    }
  }
}

TEST(Impact, ALossyCradleHandsOnWhatOneImpactAfterTheOtherWould) {
  // Balls of equal mass exchange (1 + e)/2 of the approach; e = 0.9, one in: 0.95^4 leaves at the end.
  for (const double h : kStepLengths) {
    for (const double gap : {0.0, 1e-9}) {
      World world = cradle(1, gap, 0.9, with_step(h));
      run(world, static_cast<int>(std::lround(1.0 / h)));
      EXPECT_NEAR(world.motion(4).v.x(), std::pow(0.95, 4), 1e-13);
      EXPECT_NEAR(world.compute_conserved().momentum.x(), 1.0, 1e-14);
      EXPECT_LE(world.compute_conserved().kinetic_energy, 0.5);
    }
  }
}

/// Velocities of five equal balls on a line after all their impacts, pair by pair in order of time.
std::array<double, 5> lossy_cradle(int arriving, double gap, double restitution) {
  std::array<double, 5> v{};
  std::array<double, 4> gaps;
  gaps.fill(gap);
  gaps[static_cast<std::size_t>(arriving) - 1] += 0.5;
  std::fill_n(v.begin(), arriving, 1.0);
  while (true) {
    std::size_t pair = 4;
    double time = kInfinity;
    for (std::size_t i = 0; i < 4; ++i) {
      if (v[i] - v[i + 1] <= 1e-14 || gaps[i] / (v[i] - v[i + 1]) >= time) continue;
      pair = i;
      time = gaps[i] / (v[i] - v[i + 1]);
    }
    if (pair == 4) return v;
    for (std::size_t i = 0; i < 4; ++i) gaps[i] -= time * (v[i] - v[i + 1]);
    gaps[pair] = 0.0;
    const double mean = 0.5 * (v[pair] + v[pair + 1]), apart = 0.5 * restitution * (v[pair] - v[pair + 1]);
    v[pair] = mean - apart;
    v[pair + 1] = mean + apart;
  }
}

TEST(Impact, ALossyCradleOfSeveralHandsOnWhatPairAfterPairWould) {
  for (const double h : kStepLengths) {
    for (const double gap : {0.0, 1e-9}) {
      for (int arriving = 1; arriving <= 4; ++arriving) {
        World world = cradle(arriving, gap, 0.9, with_step(h));
        run(world, static_cast<int>(std::lround(1.0 / h)));
        const std::array<double, 5> expected = lossy_cradle(arriving, 1e-9, 0.9);
        for (std::uint32_t i = 0; i < 5; ++i) {
          EXPECT_NEAR(world.motion(i).v.x(), expected[i], 1e-13) << h << " " << gap << " " << arriving;
        }
        EXPECT_NEAR(world.compute_conserved().momentum.x(), arriving, 1e-14);
      }
    }
  }
}

}  // namespace
}  // namespace tumble
