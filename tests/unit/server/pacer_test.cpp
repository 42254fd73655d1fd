// Real time: deadlines don't drift, a short hiccup is caught up, a long one forgotten and counted, and the lag never
// exceeds its bound.
#include "pacer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "support/fake_clock.h"

namespace tumble {
namespace {

constexpr double kRate = 250.0;  // period 4 ms: exact in nanoseconds
constexpr std::int64_t kPeriod = 4'000'000;

TEST(Pacer, DeadlinesDoNotDrift) {
  FakeClock clock;
  Pacer pacer(kRate);
  const std::int64_t start = clock.now_ns();
  pacer.restart(start);
  for (int step = 1; step <= 10000; ++step) {
    clock.pass(0.0013);  // the step's own cost
    pacer.advance(clock.now_ns());
    clock.sleep_until(pacer.due());
    ASSERT_EQ(clock.now_ns(), start + step * kPeriod);
  }
  EXPECT_EQ(pacer.overruns(), 0);
}

TEST(Pacer, AShortHiccupIsCaughtUp) {
  FakeClock clock;
  Pacer pacer(kRate);
  const std::int64_t start = clock.now_ns();
  pacer.restart(start);
  clock.pass(0.030);
  for (int step = 0; step < 20; ++step) {
    pacer.advance(clock.now_ns());
    clock.sleep_until(pacer.due());
  }
  EXPECT_EQ(clock.now_ns(), start + 20 * kPeriod);
  EXPECT_EQ(pacer.steps_skipped(), 0);
  EXPECT_EQ(pacer.overruns(), 7);  // of the deadlines at 4, 8 .. 28 ms
}

TEST(Pacer, ALongOneIsForgottenAndCounted) {
  FakeClock clock;
  Pacer pacer(kRate);
  pacer.restart(clock.now_ns());
  clock.pass(1.0);
  pacer.advance(clock.now_ns());
  EXPECT_EQ(pacer.steps_skipped(), 249);
  EXPECT_LE(clock.now_ns() - pacer.due(), kPeriod);
}

TEST(Pacer, TheLagStaysBoundedWhenEveryStepIsTooSlow) {
  FakeClock clock;
  Pacer pacer(kRate);
  pacer.restart(clock.now_ns());
  std::mt19937 random(4);
  std::int64_t worst = 0;
  for (int step = 0; step < 10000; ++step) {
    clock.pass(1e-3 * static_cast<double>(random() % 20));  // 9.5 ms on average, for a period of 4
    pacer.advance(clock.now_ns());
    worst = std::max(worst, clock.now_ns() - pacer.due());
    clock.sleep_until(pacer.due());
  }
  EXPECT_LE(worst, Pacer::kMaxLag);
  EXPECT_GT(pacer.steps_skipped(), 10000);
}

}  // namespace
}  // namespace tumble
