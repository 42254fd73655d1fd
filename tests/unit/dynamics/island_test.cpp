// Islands are the connected components of the bodies that can move, in an order that depends on indices alone.
#include "dynamics/island.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace tumble {
namespace {

constexpr std::uint32_t kFixed = IslandEdge::kImmovable;
using Indices = std::vector<std::uint32_t>;

TEST(Islands, NothingToGroupGivesNoIsland) {
  Islands islands;
  IslandBuilder().build(10, {}, {}, islands);
  EXPECT_EQ(islands.count(), 0u);
}

TEST(Islands, ABodyWithoutEdgesIsAnIsland) {
  Islands islands;
  IslandBuilder().build(10, {2, 5}, {}, islands);
  EXPECT_EQ(islands.count(), 2u);
  EXPECT_EQ(islands.bodies, (Indices{2, 5}));
  EXPECT_EQ(islands.body_begin, (Indices{0, 1, 2}));
  EXPECT_EQ(islands.edge_begin, (Indices{0, 0, 0}));
}

TEST(Islands, TheGroundDoesNotJoinWhatStandsOnIt) {
  Islands islands;
  IslandBuilder().build(4, {0, 1, 2, 3}, {{0, kFixed}, {kFixed, 3}, {1, kFixed}, {3, 0}}, islands);
  EXPECT_EQ(islands.bodies, (Indices{0, 3, 1, 2}));
  EXPECT_EQ(islands.body_begin, (Indices{0, 2, 3, 4}));
  EXPECT_EQ(islands.edges, (Indices{0, 1, 3, 2}));
  EXPECT_EQ(islands.edge_begin, (Indices{0, 3, 4, 4}));
}

TEST(Islands, EqualConnectedComponentsOfRandomGraphs) {
  std::mt19937 random(1);
  IslandBuilder builder;
  Islands islands;
  for (int round = 0; round < 300; ++round) {
    const std::uint32_t capacity = 1 + random() % 60;
    Indices movable;
    for (std::uint32_t i = 0; i < capacity; ++i) {
      if (random() % 4 != 0) movable.push_back(i);
    }
    std::vector<IslandEdge> edges;
    for (std::uint32_t e = random() % 50; e > 0 && !movable.empty(); --e) {
      const std::uint32_t a = movable[random() % movable.size()];
      const std::uint32_t b = random() % 5 == 0 ? kFixed : movable[random() % movable.size()];
      edges.push_back(random() % 2 ? IslandEdge{a, b} : IslandEdge{b, a});
    }
    // Reference: spread the smallest label along the edges until nothing changes.
    Indices label(capacity);
    for (std::uint32_t i = 0; i < capacity; ++i) label[i] = i;
    for (bool changed = true; changed;) {
      changed = false;
      for (const IslandEdge& e : edges) {
        if (e.a == kFixed || e.b == kFixed || label[e.a] == label[e.b]) continue;
        label[e.a] = label[e.b] = std::min(label[e.a], label[e.b]);
        changed = true;
      }
    }
    builder.build(capacity, movable, edges, islands);
    ASSERT_EQ(islands.bodies.size(), movable.size());
    ASSERT_EQ(islands.edges.size(), edges.size());
    std::uint32_t last_label = 0;
    for (std::size_t i = 0; i < islands.count(); ++i) {
      const Indices bodies(islands.bodies.begin() + islands.body_begin[i],
                           islands.bodies.begin() + islands.body_begin[i + 1]);
      ASSERT_FALSE(bodies.empty());
      ASSERT_TRUE(std::is_sorted(bodies.begin(), bodies.end()));
      ASSERT_EQ(bodies[0], label[bodies[0]]);
      ASSERT_TRUE(i == 0 || bodies[0] > last_label);
      last_label = bodies[0];
      for (const std::uint32_t body : movable) {
        ASSERT_EQ(std::binary_search(bodies.begin(), bodies.end(), body), label[body] == bodies[0]);
      }
      for (std::uint32_t e = islands.edge_begin[i]; e < islands.edge_begin[i + 1]; ++e) {
        const IslandEdge& edge = edges[islands.edges[e]];
        ASSERT_EQ(label[edge.a == kFixed ? edge.b : edge.a], bodies[0]);
        ASSERT_TRUE(e == islands.edge_begin[i] || islands.edges[e] > islands.edges[e - 1]);
      }
    }
  }
}

TEST(Islands, DoNotDependOnTheOrderOfEdges) {
  std::vector<IslandEdge> edges;
  Indices movable;
  for (std::uint32_t i = 0; i < 100; ++i) {
    movable.push_back(i);
    if (i % 10 != 0) edges.push_back({i, i - 1});
  }
  Islands first, second;
  IslandBuilder builder;
  builder.build(100, movable, edges, first);
  std::reverse(edges.begin(), edges.end());
  builder.build(100, movable, edges, second);
  EXPECT_EQ(first.count(), 10u);
  EXPECT_EQ(first.bodies, second.bodies);
  EXPECT_EQ(first.body_begin, second.body_begin);
}

}  // namespace
}  // namespace tumble
