// Lanes are rounded as doubles are and never mixed up.
#include "math/four.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace tumble {
namespace {

TEST(Four, FirstLowestIsTheFirstOfEquals) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 5000; ++i) {
    std::vector<double> numbers(4 * (1 + random() % 6));
    for (double& x : numbers) x = static_cast<double>(random() % 7) - 3.0;
    FirstLowest lowest;
    for (std::size_t k = 0; k < numbers.size(); k += 4) lowest.look_at(load_four(&numbers[k]));
    const auto expected = std::min_element(numbers.begin(), numbers.end());
    ASSERT_EQ(lowest.index(), expected - numbers.begin());
    ASSERT_EQ(lowest.value(), *expected);
  }
}

TEST(Four, ReadsAndWritesFourAndNoMore) {
  std::array<double, 6> numbers = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  store_four(2.0 * load_four(&numbers[1]), &numbers[1]);
  EXPECT_EQ(numbers, (std::array<double, 6>{1.0, 4.0, 6.0, 8.0, 10.0, 6.0}));
}

TEST(Four, EveryLaneIsItsOwn) {
  const FourVectors v = {Four{1, 2, 3, 4}, Four{5, 6, 7, 8}, Four{9, 10, 11, 12}};
  FourVectors w = v;
  w.set(2, Vec3(-1.0, -2.0, -3.0));
  const Four products = dot(w, Vec3(1.0, 10.0, 100.0));
  EXPECT_EQ(products[0], 951.0);
  EXPECT_EQ(products[1], 1062.0);
  EXPECT_EQ(products[2], -321.0);
  EXPECT_EQ(products[3], 1284.0);
  EXPECT_EQ(least_lane(products)[0], -321.0);
  EXPECT_EQ(least_lane(products)[3], -321.0);
  std::vector<std::size_t> lanes;
  for_each_lane(products > four(1000.0), [&](std::size_t lane) { lanes.push_back(lane); });
  EXPECT_EQ(lanes, (std::vector<std::size_t>{1, 3}));
  EXPECT_FALSE(any(products > four(1e4)));
}

}  // namespace
}  // namespace tumble
