// The broad phase reports every pair that could touch exactly once per renewal, sorted, and nothing else.
#include "collision/broad_phase.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "allocation_counter.h"

namespace tumble {
namespace {

constexpr double kMargin = 0.05;

/// Unit boxes flying through a cage and bouncing off its walls; every `fixed_every`-th one does not move.
class Crowd {
 public:
  Crowd(std::uint32_t count, double speed, unsigned seed) : random_(seed) {
    for (std::uint32_t i = 0; i < count; ++i) {
      center_.push_back(random_vector(kCage));
      velocity_.push_back(random_vector(speed));
      moves_.push_back(i % 5 != 0);
      present_.push_back(false);
      add(i);
    }
  }

  void add(std::uint32_t i) {
    phase.add(i, tight(i), kMargin, moves_[i]);
    present_[i] = true;
  }
  void remove(std::uint32_t i) {
    phase.remove(i);
    present_[i] = false;
    std::erase_if(known, [i](const GeometryPair& p) { return p.a == i || p.b == i; });
  }
  void advance() {
    for (std::uint32_t i = 0; i < center_.size(); ++i) {
      if (!present_[i] || !moves_[i]) continue;
      center_[i] += velocity_[i];
      for (int k = 0; k < 3; ++k) {
        if (std::abs(center_[i][k]) > kCage) velocity_[i][k] = -std::copysign(velocity_[i][k], center_[i][k]);
      }
      phase.move(i, tight(i), kMargin, velocity_[i]);
    }
  }
  /// Keeps the set of pairs as a contact graph would.
  void update() {
    std::erase_if(known, [this](const GeometryPair& p) { return !phase.overlaps(p); });
    found.clear();
    phase.update_pairs(found);
    known.insert(found.begin(), found.end());
  }
  std::set<GeometryPair> brute_force() const {
    std::set<GeometryPair> pairs;
    for (std::uint32_t a = 0; a < center_.size(); ++a) {
      for (std::uint32_t b = a + 1; b < center_.size(); ++b) {
        if (!present_[a] || !present_[b] || (!moves_[a] && !moves_[b])) continue;
        if (phase.fat_bounds(a).overlaps(phase.fat_bounds(b))) pairs.insert({a, b});
      }
    }
    return pairs;
  }
  Aabb tight(std::uint32_t i) const { return Aabb{center_[i], center_[i]}.grown(0.5); }
  bool present(std::uint32_t i) const { return present_[i]; }
  const Vec3& velocity(std::uint32_t i) const { return velocity_[i]; }

  BroadPhase phase;
  std::set<GeometryPair> known;
  std::vector<GeometryPair> found;

 private:
  static constexpr double kCage = 6.0;
  Vec3 random_vector(double size) {
    std::uniform_real_distribution<double> uniform(-size, size);
    Vec3 v;
    for (int k = 0; k < 3; ++k) v[k] = uniform(random_);
    return v;
  }
  std::mt19937 random_;
  std::vector<Vec3> center_, velocity_;
  std::vector<bool> moves_, present_;
};

TEST(BroadPhase, PairsEqualBruteForceThroughMotionRemovalAndReturn) {
  Crowd crowd(150, 0.1, 1);
  std::mt19937 random(2);
  for (int step = 0; step < 400; ++step) {
    crowd.advance();
    const std::uint32_t i = random() % 150;
    if (crowd.present(i)) {
      crowd.remove(i);
      if (step % 3 == 0) crowd.add(i);  // away and back between two updates
    } else {
      crowd.add(i);
    }
    crowd.update();
    ASSERT_EQ(crowd.known, crowd.brute_force()) << "step " << step;
    ASSERT_TRUE(std::is_sorted(crowd.found.begin(), crowd.found.end()));
    ASSERT_EQ(std::adjacent_find(crowd.found.begin(), crowd.found.end()), crowd.found.end());
    for (const GeometryPair& pair : crowd.found) ASSERT_LT(pair.a, pair.b);
  }
}

TEST(BroadPhase, FatBoxAlwaysCoversTheStepAhead) {
  for (const double speed : {0.001, 0.1, 3.0}) {
    Crowd crowd(50, speed, 3);
    for (int step = 0; step < 200; ++step) {
      crowd.advance();
      for (std::uint32_t i = 1; i < 50; ++i) {
        if (i % 5 == 0) continue;
        ASSERT_TRUE(crowd.phase.fat_bounds(i).contains(crowd.tight(i).swept(crowd.velocity(i))));
      }
    }
  }
}

TEST(BroadPhase, NothingIsRenewedOrReportedAtRest) {
  Crowd crowd(100, 0.0, 4);
  crowd.update();
  EXPECT_FALSE(crowd.found.empty());
  crowd.advance();
  crowd.update();
  EXPECT_TRUE(crowd.found.empty());
  EXPECT_EQ(crowd.phase.boxes_renewed(), 0u);
}

TEST(BroadPhase, BoxIsRenewedOnlyWhenItIsLeft) {
  BroadPhase phase;
  const Aabb box{Vec3::Zero(), Vec3::Ones()};
  phase.add(0, box, kMargin, true);
  const auto at = [&](double x) { return Aabb{box.lower + Vec3(x, 0, 0), box.upper + Vec3(x, 0, 0)}; };
  EXPECT_FALSE(phase.move(0, at(0.049), kMargin, Vec3::Zero()));
  EXPECT_FALSE(phase.move(0, at(-0.049), kMargin, Vec3::Zero()));
  EXPECT_TRUE(phase.move(0, at(0.051), kMargin, Vec3::Zero()));
  EXPECT_FALSE(phase.move(0, at(0.1), kMargin, Vec3::Zero()));
  EXPECT_EQ(phase.boxes_renewed(), 1u);
}

TEST(BroadPhase, ThingsThatNeverMoveDoNotPair) {
  BroadPhase phase;
  const Aabb box{Vec3::Zero(), Vec3::Ones()};
  std::vector<GeometryPair> pairs;
  phase.add(0, box, kMargin, false);
  phase.add(1, box, kMargin, false);
  phase.update_pairs(pairs);
  EXPECT_TRUE(pairs.empty());
  phase.add(2, box, kMargin, true);
  phase.update_pairs(pairs);
  EXPECT_EQ(pairs, (std::vector<GeometryPair>{{0, 2}, {1, 2}}));
}

TEST(BroadPhase, AFixedGeometryThatIsPutElsewhereMeetsWhatRestsThere) {
  BroadPhase phase;
  const Aabb box{Vec3::Zero(), Vec3::Ones()};
  const Aabb far{Vec3::Constant(10), Vec3::Constant(11)};
  std::vector<GeometryPair> pairs;
  phase.add(0, box, kMargin, true);
  phase.add(1, far, kMargin, false);
  phase.update_pairs(pairs);
  EXPECT_TRUE(pairs.empty());
  EXPECT_TRUE(phase.move(1, box, kMargin, Vec3::Zero()));
  phase.update_pairs(pairs);
  EXPECT_EQ(pairs, (std::vector<GeometryPair>{{0, 1}}));
}

TEST(BroadPhase, HalfSpacesWithInfiniteBoxesPairAndStay) {
  Crowd crowd(60, 0.1, 5);
  const Aabb ground{Vec3::Constant(-kInfinity), Vec3(kInfinity, kInfinity, -1.0)};
  crowd.phase.add(60, ground, kMargin, false);
  std::set<std::uint32_t> touching;
  for (int step = 0; step < 100; ++step) {
    crowd.advance();
    EXPECT_FALSE(crowd.phase.move(60, ground, kMargin, Vec3::Zero()));
    std::erase_if(touching, [&](std::uint32_t i) { return !crowd.phase.overlaps({i, 60}); });
    std::vector<GeometryPair> pairs;
    crowd.phase.update_pairs(pairs);
    for (const GeometryPair& pair : pairs) {
      if (pair.b == 60) touching.insert(pair.a);
    }
    for (std::uint32_t i = 0; i < 60; ++i) {
      const bool expected = i % 5 != 0 && crowd.phase.fat_bounds(i).lower.z() <= -1.0 + kMargin;
      ASSERT_EQ(touching.count(i) == 1, expected) << i;
    }
  }
  EXPECT_GT(touching.size(), 10u);
}

TEST(BroadPhase, QueryIsAscendingAndComplete) {
  const Crowd crowd(100, 0.1, 6);
  const Aabb bounds{Vec3::Constant(-4.0), Vec3::Constant(3.0)};
  std::vector<std::uint32_t> indices, expected;
  crowd.phase.query(bounds, indices);
  for (std::uint32_t i = 0; i < 100; ++i) {
    if (crowd.phase.fat_bounds(i).overlaps(bounds)) expected.push_back(i);
  }
  EXPECT_EQ(indices, expected);
  EXPECT_GT(expected.size(), 5u);
}

TEST(BroadPhase, CopyContinuesLikeTheOriginal) {
  Crowd original(100, 0.1, 7);
  for (int step = 0; step < 20; ++step) original.advance();
  Crowd copy = original;  // with unreported renewals pending
  for (int step = 0; step < 50; ++step) {
    original.update();
    copy.update();
    ASSERT_EQ(original.found, copy.found);
    original.advance();
    copy.advance();
  }
  EXPECT_EQ(original.phase.boxes_renewed(), copy.phase.boxes_renewed());
}

TEST(BroadPhase, NoAllocationAfterWarmUp) {
  Crowd crowd(150, 0.1, 9);
  std::vector<GeometryPair> pairs;
  std::vector<std::uint32_t> indices;
  const auto step = [&] {
    crowd.advance();
    pairs.clear();
    crowd.phase.update_pairs(pairs);
    indices.clear();
    crowd.phase.query({Vec3::Constant(-3), Vec3::Constant(3)}, indices);
    crowd.phase.remove(7);
    crowd.phase.add(7, crowd.tight(7), kMargin, true);
  };
  pairs.reserve(10000);
  for (int i = 0; i < 200; ++i) step();
  const std::uint64_t before = test::allocation_count();
  for (int i = 0; i < 200; ++i) step();
  EXPECT_EQ(test::allocation_count(), before);
}

}  // namespace
}  // namespace tumble
