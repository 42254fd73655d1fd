// The parts of stats_t that come from the world and from the network.
#pragma once

#include "net/command_inbox.h"
#include "net/outbox.h"
#include "tumble/stats_t.hpp"
#include "world/world.h"

namespace tumble {

/// State, report and counters of `world`; changes are against `start`, its sums at the start of the session.
void fill_world_stats(const World& world, const Conserved& start, stats_t& stats);
void fill_network_stats(const InboxCounters& inbox, const OutboxCounters& outbox, stats_t& stats);

}  // namespace tumble
