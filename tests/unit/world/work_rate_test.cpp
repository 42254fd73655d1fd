// A limit of work on exact solutions: counted, not timed, and what exceeds it is solved by sub-steps.
#include <gtest/gtest.h>

#include "support/heap_scenes.h"

namespace tumble {
namespace {

using namespace test;

World heap_after(double seconds, double work_rate) {
  Options options;
  options.work_rate = work_rate;
  World world = heap(options, 30, 3, false);
  while (world.time() < seconds) world.step();
  return world;
}

TEST(WorkRate, LimitsExactSolutionsAndSavesUpForLater) {
  const World unlimited = heap_after(0.5, 0.0), limited = heap_after(0.5, 1e4), none = heap_after(0.5, 1.0);
  EXPECT_GT(unlimited.counters().exact_work, 30'000u);  // measured: 63 969
  // 1e4 a second, and what the last solution took beyond what it was expected to; measured: 5035
  EXPECT_LE(limited.counters().exact_work, 5'500u);
  EXPECT_GT(limited.counters().exact_work, 1'000u);
  EXPECT_EQ(none.counters().exact_work, 0u);
  EXPECT_EQ(limited.counters().non_finite_contained, 0u);
}

TEST(WorkRate, IsTheSameEveryTime) {
  const World once = heap_after(0.4, 1e4), again = heap_after(0.4, 1e4);
  EXPECT_EQ(largest_displacement(once, again), 0.0);
}

}  // namespace
}  // namespace tumble
