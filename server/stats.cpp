// See stats.h.
#include "stats.h"

#include <algorithm>

namespace tumble {
namespace {

std::int64_t count(std::uint64_t value) {
  return static_cast<std::int64_t>(value);
}

}  // namespace

void fill_world_stats(const World& world, const Conserved& start, stats_t& stats) {
  const StepReport& report = world.report();
  stats.step = count(world.step_count());
  stats.time = world.time();
  stats.bodies = static_cast<std::int32_t>(world.body_count());
  stats.bodies_awake = static_cast<std::int32_t>(report.bodies_awake);
  stats.bodies_resting = static_cast<std::int32_t>(report.bodies_resting);
  stats.pairs = static_cast<std::int32_t>(report.pairs);
  stats.contacts = static_cast<std::int32_t>(report.contacts);
  stats.islands = static_cast<std::int32_t>(report.islands);
  stats.deepest_penetration = report.deepest_penetration;
  stats.max_residual = report.max_residual;

  const Conserved now = world.compute_conserved();
  stats.kinetic_energy = now.kinetic_energy;
  stats.potential_energy = now.potential_energy;
  std::copy_n(now.momentum.data(), 3, stats.momentum);
  std::copy_n(now.angular_momentum.data(), 3, stats.angular_momentum);
  stats.energy_change =
      (now.kinetic_energy - start.kinetic_energy) + (now.potential_energy - start.potential_energy);
  stats.momentum_change = (now.momentum - start.momentum).norm();

  const Counters& counters = world.counters();
  stats.bodies_stepped = count(counters.bodies_stepped);
  stats.bodies_skipped_resting = count(counters.bodies_skipped_resting);
  stats.bodies_skipped_flying = count(counters.bodies_skipped_flying);
  stats.pairs_skipped_clear = count(counters.pairs_skipped_clear);
  stats.islands_solved = count(counters.islands_solved);
  stats.islands_accepted = count(counters.islands_accepted);
  stats.islands_free = count(counters.islands_free);
  stats.islands_smooth = count(counters.islands_smooth);
  stats.islands_exact = count(counters.islands_exact);
  stats.solver_iterations = count(counters.solver_iterations);
  stats.newton_steps = count(counters.newton_steps);
  stats.solver_fallbacks = count(counters.solver_fallbacks);
  stats.overlaps_removed = count(counters.overlaps_removed);
  stats.slides_ended = count(counters.slides_ended);
  stats.taut_parts = count(counters.taut_parts);
  stats.sweeps = count(counters.sweeps);
  stats.impacts = count(counters.impacts);
  stats.rests = count(counters.rests);
  stats.wakes = count(counters.wakes);
  stats.non_finite_contained = count(counters.non_finite_contained);
}

void fill_network_stats(const InboxCounters& inbox, const OutboxCounters& outbox, stats_t& stats) {
  stats.commands_applied = count(inbox.applied);
  stats.commands_refused = count(inbox.refused);
  stats.commands_repeated = count(inbox.repeated);
  stats.messages_malformed = count(inbox.damaged());
  stats.frames_published = count(outbox.frames);
  stats.frames_dropped = count(outbox.frames_dropped);
  stats.datagrams_sent = count(outbox.datagrams);
  stats.bytes_sent = count(outbox.bytes);
  stats.publish_errors = count(outbox.errors);
}

}  // namespace tumble
