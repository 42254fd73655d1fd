// Where the time of a tick goes: sums since the last report, for stats_t.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "tumble/stats_t.hpp"
#include "world/diagnostics.h"

namespace tumble {

class StepMeter {
 public:
  /// Times are now_ns of the server's clock.
  void begin_tick(std::int64_t now) { tick_start_ = mark_ = now; }
  /// The time since the last mark was spent on this.
  void end_commands(std::int64_t now) { commands_ += lap(now); }
  void end_stage(Stage stage, std::int64_t now) { stages_[static_cast<std::size_t>(stage)] += lap(now); }
  void end_step(std::int64_t now) {
    mark_ = now;
    ++steps_;
  }
  void end_publication(std::int64_t now) {
    publish_ += lap(now);
    ++publications_;
  }
  void end_tick(std::int64_t now) {
    ticks_ += now - tick_start_;
    longest_ = std::max(longest_, now - tick_start_);
  }

  /// Writes rates and times into `stats` and starts a new interval. `dt` is the world's step [s]; `io_busy` the I/O
  /// thread's work since the start [ns].
  void report(std::int64_t now, double dt, std::int64_t io_busy, stats_t& stats);

 private:
  std::int64_t lap(std::int64_t now) {
    const std::int64_t spent = now - mark_;
    mark_ = now;
    return spent;
  }

  std::int64_t tick_start_ = 0, mark_ = 0;
  std::int64_t interval_start_ = -1, io_busy_ = 0;
  std::int64_t steps_ = 0, publications_ = 0;
  std::int64_t ticks_ = 0, longest_ = 0, commands_ = 0, publish_ = 0;
  std::array<std::int64_t, static_cast<std::size_t>(Stage::count)> stages_{};
};

}  // namespace tumble
