// Real time by absolute deadlines: step k is due at start + k * period, so that late steps don't shift the ones after
// them. A step that is late by more than `kMaxLag` cannot be caught up: whole periods are given up, counted, and the
// schedule moves; so the lag never grows and the world runs slower than the clock instead.
#pragma once

#include <cstdint>

namespace tumble {

class Pacer {
 public:
  /// A hiccup this long is caught up by stepping without pause; a longer one is forgotten [ns].
  static constexpr std::int64_t kMaxLag = 50'000'000;

  explicit Pacer(double rate) : period_(static_cast<std::int64_t>(1e9 / rate)) {}  ///< [1/s]

  /// Restarts the schedule: the next step is due at `now` [ns].
  void restart(std::int64_t now) { due_ = now; }
  std::int64_t due() const { return due_; }

  /// A step ended at `now`: moves on to the next one's deadline.
  void advance(std::int64_t now) {
    due_ += period_;
    if (now <= due_) return;
    ++overruns_;
    const std::int64_t lag = now - due_;
    if (lag <= kMaxLag) return;
    const std::int64_t skipped = lag / period_;
    due_ += skipped * period_;
    steps_skipped_ += skipped;
  }

  std::int64_t overruns() const { return overruns_; }  ///< Steps that ended after the next one was due.
  std::int64_t steps_skipped() const { return steps_skipped_; }  ///< Periods given up.

 private:
  std::int64_t period_, due_ = 0, overruns_ = 0, steps_skipped_ = 0;
};

}  // namespace tumble
