// See step_meter.h.
#include "step_meter.h"

namespace tumble {

void StepMeter::report(std::int64_t now, double dt, std::int64_t io_busy, stats_t& stats) {
  const double seconds = interval_start_ < 0 ? 0.0 : static_cast<double>(now - interval_start_) * 1e-9;
  const auto per = [](std::int64_t ns, std::int64_t count) {
    return count > 0 ? static_cast<double>(ns) * 1e-6 / static_cast<double>(count) : 0.0;
  };
  const auto stage = [&](Stage which) { return per(stages_[static_cast<std::size_t>(which)], steps_); };
  stats.rate = seconds > 0.0 ? static_cast<double>(steps_) / seconds : 0.0;
  stats.real_time_factor = stats.rate * dt;
  stats.step_ms = per(ticks_, steps_);
  stats.step_ms_max = per(longest_, 1);
  stats.commands_ms = per(commands_, steps_) + stage(Stage::commands);
  stats.broad_phase_ms = stage(Stage::broad_phase);
  stats.narrow_phase_ms = stage(Stage::narrow_phase);
  stats.islands_ms = stage(Stage::islands);
  stats.solve_ms = stage(Stage::solve);
  stats.report_ms = stage(Stage::report);
  stats.publish_ms = per(publish_, publications_);
  stats.io_ms = per(io_busy - io_busy_, publications_);
  *this = StepMeter();
  interval_start_ = now;
  io_busy_ = io_busy;
}

}  // namespace tumble
