// The tree gives exactly the boxes that overlap, through any history of insertions, moves and removals.
#include "collision/aabb_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <random>

namespace tumble {
namespace {

Aabb random_box(std::mt19937& random, double world, double size) {
  std::uniform_real_distribution<double> at(-world, world), extent(0.0, size);
  Aabb box;
  for (int i = 0; i < 3; ++i) {
    box.lower[i] = at(random);
    box.upper[i] = box.lower[i] + extent(random);
  }
  return box;
}

std::vector<std::uint32_t> sorted_query(const AabbTree& tree, const Aabb& bounds) {
  std::vector<std::uint32_t> users;
  tree.query(bounds, users);
  std::sort(users.begin(), users.end());
  return users;
}

/// The tree beside a plain map of the same boxes.
struct CheckedTree {
  AabbTree tree;
  std::map<std::uint32_t, std::pair<AabbTree::Leaf, Aabb>> boxes;

  void insert(std::uint32_t user, const Aabb& box) { boxes[user] = {tree.insert(box, user), box}; }
  void move(std::uint32_t user, const Aabb& box) {
    tree.move(boxes.at(user).first, box);
    boxes.at(user).second = box;
  }
  void remove(std::uint32_t user) {
    tree.remove(boxes.at(user).first);
    boxes.erase(user);
  }
  std::vector<std::uint32_t> overlapping(const Aabb& bounds) const {
    std::vector<std::uint32_t> users;
    for (const auto& [user, entry] : boxes) {
      if (entry.second.overlaps(bounds)) users.push_back(user);
    }
    return users;
  }
};

TEST(AabbTree, EmptyTreeAnswersNothing) {
  const AabbTree tree;
  EXPECT_EQ(tree.height(), -1);
  EXPECT_EQ(tree.size(), 0u);
  EXPECT_TRUE(sorted_query(tree, {Vec3::Constant(-kInfinity), Vec3::Constant(kInfinity)}).empty());
}

TEST(AabbTree, BoxesThatOnlyTouchOverlap) {
  AabbTree tree;
  tree.insert({Vec3(0, 0, 0), Vec3(1, 1, 1)}, 7);
  EXPECT_EQ(sorted_query(tree, {Vec3(1, 1, 1), Vec3(2, 2, 2)}), std::vector<std::uint32_t>{7});
  EXPECT_TRUE(sorted_query(tree, {Vec3(std::nextafter(1.0, 2.0), 1, 1), Vec3(2, 2, 2)}).empty());
}

TEST(AabbTree, AnswersEqualBruteForceThroughARandomHistory) {
  std::mt19937 random(1);
  CheckedTree checked;
  std::uint32_t next = 0;
  for (int round = 0; round < 4000; ++round) {
    const unsigned action = random() % 10;
    if (checked.boxes.empty() || action < 4) {
      checked.insert(next++, random_box(random, 10.0, 3.0));
    } else {
      const auto chosen =
          std::next(checked.boxes.begin(), static_cast<long>(random() % checked.boxes.size()));
      if (action < 7) {
        checked.move(chosen->first, random_box(random, 10.0, 3.0));
      } else {
        checked.remove(chosen->first);
      }
    }
    ASSERT_EQ(checked.tree.size(), checked.boxes.size());
    const Aabb bounds = random_box(random, 10.0, 6.0);
    ASSERT_EQ(sorted_query(checked.tree, bounds), checked.overlapping(bounds)) << "round " << round;
  }
  EXPECT_GT(checked.boxes.size(), 300u);
  while (!checked.boxes.empty()) checked.remove(checked.boxes.begin()->first);
  EXPECT_EQ(checked.tree.height(), -1);
}

TEST(AabbTree, InfiniteBoxesAreFoundAndDoNotSpoilTheTree) {
  std::mt19937 random(2);
  CheckedTree checked;
  checked.insert(0, {Vec3::Constant(-kInfinity), Vec3(kInfinity, kInfinity, 0.0)});  // the ground
  checked.insert(1, {Vec3::Constant(-kInfinity), Vec3::Constant(kInfinity)});        // a tilted half-space
  for (std::uint32_t user = 2; user < 1002; ++user) checked.insert(user, random_box(random, 50.0, 1.0));
  checked.insert(1002, {Vec3(5.0, -kInfinity, -kInfinity), Vec3::Constant(kInfinity)});  // a wall
  for (int i = 0; i < 500; ++i) {
    const Aabb bounds = random_box(random, 50.0, 4.0);
    ASSERT_EQ(sorted_query(checked.tree, bounds), checked.overlapping(bounds));
  }
  EXPECT_LE(checked.tree.height(), 22);  // measured 18; log2(1003) = 10
}

TEST(AabbTree, RotationsKeepARowInsertedInOrderShallow) {
  AabbTree tree;
  for (std::uint32_t i = 0; i < 1024; ++i) tree.insert({Vec3(i, 0, 0), Vec3(i + 0.9, 1, 1)}, i);
  EXPECT_LE(tree.height(), 20);  // measured 10; without rotations 1023
}

TEST(AabbTree, CopyIsIndependent) {
  std::mt19937 random(3);
  CheckedTree original;
  for (std::uint32_t user = 0; user < 100; ++user) original.insert(user, random_box(random, 5.0, 2.0));
  const CheckedTree copy = original;
  for (std::uint32_t user = 0; user < 100; user += 2) original.remove(user);
  for (int i = 0; i < 200; ++i) {
    const Aabb bounds = random_box(random, 5.0, 2.0);
    ASSERT_EQ(sorted_query(copy.tree, bounds), copy.overlapping(bounds));
    ASSERT_EQ(sorted_query(original.tree, bounds), original.overlapping(bounds));
  }
}

}  // namespace
}  // namespace tumble
