// Pairs are held once; impulses follow their points from one manifold to the next.
#include "world/contact_graph.h"

#include <gtest/gtest.h>

namespace tumble::test {
namespace {

constexpr double kReach = 0.01;

/// Points side by side along x, a metre apart, with these names.
Manifold manifold_of(const std::vector<std::uint32_t>& names) {
  Manifold manifold;
  for (const std::uint32_t name : names) {
    manifold.points[static_cast<std::size_t>(manifold.count)] = {Vec3(manifold.count, 0, 0), 0.0, name};
    ++manifold.count;
  }
  return manifold;
}

Impulses impulses_of(const std::vector<double>& along_z) {
  Impulses impulses;
  impulses.fill(Vec3::Zero());
  for (std::size_t i = 0; i < along_z.size(); ++i) impulses[i] = Vec3(0.5, 0, along_z[i]);
  return impulses;
}

TEST(TransportImpulses, StayWhereFeaturesDoAndNeverPull) {
  const Manifold manifold = manifold_of({7, 8, 9});
  Impulses impulse = impulses_of({1.0, -2.0, 3.0}), moment = impulses_of({0.1, 0.2, -0.3});
  transport_impulses(manifold, manifold, Vec3::UnitZ(), kReach, impulse, moment);
  EXPECT_EQ(impulse[0], Vec3(0.5, 0, 1.0));
  EXPECT_EQ(impulse[1], Vec3::Zero());
  EXPECT_EQ(impulse[2], Vec3(0.5, 0, 3.0));
  EXPECT_EQ(moment[0], Vec3(0.5, 0, 0.1));
  EXPECT_EQ(moment[1], Vec3::Zero());
  EXPECT_EQ(moment[2], Vec3(0.5, 0, -0.3));
}

TEST(TransportImpulses, FollowNamesThenPlaces) {
  const Manifold old_manifold = manifold_of({7, 8, 9});
  Manifold manifold = manifold_of({9, 5, 6, 7});
  manifold.points[1].p_A = Vec3(1.0 + 0.5 * kReach, 0, 0);  // near the old point 8
  manifold.points[2].p_A = Vec3(1.0 + 2.0 * kReach, 0, 0);  // near none
  Impulses impulse = impulses_of({1.0, 2.0, 3.0}), moment = impulses_of({0.1, 0.2, 0.3, 0.4});
  transport_impulses(old_manifold, manifold, Vec3::UnitZ(), kReach, impulse, moment);
  EXPECT_EQ(impulse[0], Vec3(0.5, 0, 3.0));
  EXPECT_EQ(impulse[1], Vec3(0.5, 0, 2.0));
  EXPECT_EQ(impulse[2], Vec3::Zero());
  EXPECT_EQ(impulse[3], Vec3(0.5, 0, 1.0));
  EXPECT_EQ(moment[0], Vec3(0.5, 0, 0.3));
  EXPECT_EQ(moment[1], Vec3(0.5, 0, 0.2));
  EXPECT_EQ(moment[2], Vec3::Zero());
  EXPECT_EQ(moment[3], Vec3(0.5, 0, 0.1));
}

Contact contact_of(GeometryPair pair) {
  Contact contact;
  contact.pair = pair;
  return contact;
}

TEST(ContactGraph, PairsThatComeLateMoreThanOnceAreHeldOnce) {
  ContactGraph graph;
  EXPECT_EQ(graph.insert({{5, 6}}, contact_of), 1u);
  EXPECT_EQ(graph.insert_late({{1, 9}}, contact_of), 1u);
  EXPECT_EQ(graph.insert_late({{0, 1}, {1, 9}, {5, 6}}, contact_of), 1u);
  graph.settle();
  ASSERT_EQ(graph.size(), 3u);
  EXPECT_EQ(graph[0].pair, (GeometryPair{0, 1}));
  EXPECT_EQ(graph[1].pair, (GeometryPair{1, 9}));
  EXPECT_EQ(graph[2].pair, (GeometryPair{5, 6}));
}

}  // namespace
}  // namespace tumble::test
