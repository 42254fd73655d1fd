// A clock that a test holds in its hand: time passes only when someone sleeps or the test says so.
#pragma once

#include "net/clock.h"

namespace tumble {

class FakeClock final : public Clock {
 public:
  std::int64_t wall_us() override { return kWallStart + now_ / 1000; }
  std::int64_t now_ns() override { return now_; }
  void sleep_until(std::int64_t ns) override {
    if (ns > now_) now_ = ns;
  }
  void pass(double seconds) { now_ += static_cast<std::int64_t>(seconds * 1e9); }

 private:
  static constexpr std::int64_t kWallStart = 1'700'000'000'000'000;
  std::int64_t now_ = 1'000'000'000;
};

}  // namespace tumble
