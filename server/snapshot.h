// The whole inner state of a run between two steps as bytes, in events of a bounded size: world, snapshots kept by name,
// clients' histories, waiting commands. A run goes on from it with the same bits.
#pragma once

#include <functional>
#include <string>

#include "net/command_inbox.h"
#include "simulation.h"
#include "tumble/snapshot_t.hpp"

namespace tumble {

struct Snapshot {
  std::int64_t session = 0, step = 0;
  std::int64_t state_hash = 0;  ///< Of the world.
  // Bytes: equal ones are states with the same future.
  std::string world;
  std::string simulation;  ///< But for its worlds.
  std::string kept;        ///< Those that clients keep by name.
  std::string inbox;
};

/// Between two ticks: every answer has been taken out of the inbox. Without `kept`, which may follow at any time, since
/// it never changes. Overwrites `snapshot`, whose memory it uses again.
void take_snapshot(const Simulation& simulation, const CommandInbox& inbox, Snapshot& snapshot);
/// `start`: of the simulation.
void add_kept(const Simulation::KeptStates& kept, const Simulation::State& start, Snapshot& snapshot);
/// Both, for whoever has the time.
Snapshot take_whole_snapshot(const Simulation& simulation, const CommandInbox& inbox);
/// The simulations are the same; whatever the inboxes hold.
bool is_same_state(const Snapshot& a, const Snapshot& b);
/// `simulation` is of the same scene. Throws std::runtime_error if the bytes are no snapshot, or the world that comes out
/// has another hash; both are then undefined.
void restore(const Snapshot& snapshot, Simulation& simulation, CommandInbox& inbox);

/// Hands the snapshot to `send` part by part, each a message of at most kLoopbackPayload bytes.
void send_parts(const Snapshot& snapshot, std::int64_t utime,
                const std::function<void(const snapshot_t&)>& send);

/// Puts a snapshot together from its parts.
class SnapshotAssembly {
 public:
  /// True if it is whole with this part; then `snapshot()` gives it. Throws std::runtime_error for a damaged part, which
  /// voids what came before it. Parts that do not follow each other are those of a server that was killed: forgotten.
  bool add(const snapshot_t& part);
  /// Throws std::runtime_error if its bytes are no snapshot's.
  Snapshot snapshot() const;
  int parts() const { return head_.num_parts > 0 ? head_.part + 1 : 0; }

 private:
  snapshot_t head_{};  // the part before
  std::string bytes_;
};

}  // namespace tumble
