// Spreads the repetition of many things evenly over a period: how many are due now, in turn.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tumble {

class Rolling {
 public:
  explicit Rolling(double period) : period_(period) {}  ///< [s] in which everything comes round once.

  /// How many of `count` things are due at `now_ns` since the last call, at most all of them. The first call: all.
  std::uint32_t advance(std::int64_t now_ns, std::uint32_t count) {
    if (!started_) {
      started_ = true;
      last_ns_ = now_ns;
      return count;
    }
    owed_ += static_cast<double>(now_ns - last_ns_) * 1e-9 / period_ * count;
    last_ns_ = now_ns;
    const double due = std::min(std::floor(owed_), static_cast<double>(count));
    owed_ = std::min(owed_ - due, static_cast<double>(count));
    return static_cast<std::uint32_t>(due);
  }

 private:
  double period_, owed_ = 0.0;
  std::int64_t last_ns_ = 0;
  bool started_ = false;
};

}  // namespace tumble
