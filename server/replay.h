// Reads a log that a Recorder wrote and does everything in it again: every command at its step, every step compared
// with its recorded hash, every snapshot with the state that the commands led to. Or goes on from the last snapshot. At
// the end stands what the server had when it died: world, clients' histories, waiting commands, and the place in the log
// from where to go on.
#pragma once

#include <csignal>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "net/event_log.h"
#include "simulation.h"
#include "snapshot.h"
#include "step_checksum.h"
#include "tumble/recording_t.hpp"

namespace tumble {

/// A step that came out differently.
struct ReplayDifference {
  std::int64_t session = 0, step = 0;
  std::int64_t recorded_hash = 0, hash = 0;
};

class Replay {
 public:
  /// Reads the log's head and builds its world. Throws std::system_error if there is no such file,
  /// std::invalid_argument if it is not a recording or its world can't be built here.
  explicit Replay(const std::string& path);

  /// Goes to the last snapshot of the log that is whole, if there is one: the steps before it are not done again. Call it
  /// before `run`.
  void skip_to_last_snapshot();

  /// To the end of what is sound, the first difference, or until `stop`; `observer` hears of every step.
  void run(const std::function<void(const StepReport&)>& observer, const volatile std::sig_atomic_t& stop);

  const recording_t& head() const { return head_; }
  std::int64_t steps() const { return steps_; }          ///< That came out the same, over all sessions.
  std::int64_t commands() const { return commands_; }    ///< That acted.
  std::int64_t snapshots() const { return snapshots_; }  ///< That are what the commands led to.
  /// Sentences about snapshots that can't be used; the log is sound without them.
  const std::vector<std::string>& bad_snapshots() const { return bad_snapshots_; }
  /// The step, of its session, from whose snapshot the run goes on; none: from the start.
  const std::optional<std::int64_t>& skipped_to() const { return skipped_to_; }
  const std::optional<ReplayDifference>& difference() const { return difference_; }
  /// The log is sound up to here; none if it is whole.
  const std::optional<LogDamage>& damage() const { return damage_; }

  // To go on.
  Simulation& simulation() { return *simulation_; }
  CommandInbox& inbox() { return inbox_; }
  const StepChecksum& checksum() const { return checksum_; }
  std::int64_t log_size() const { return sound_size_; }
  std::int64_t log_events() const { return sound_events_; }

 private:
  struct Place {
    std::int64_t offset, events;
  };

  void read_head();
  /// Where the first parts of those stand that are whole.
  std::vector<Place> find_snapshots();
  void restore_at(Place place);
  bool replay(const LogEvent& event);
  template <typename Message>
  bool replay_command(const LogEvent& event);
  void apply(const Command& command);
  bool replay_step(const LogEvent& event);
  void replay_snapshot(const LogEvent& event);
  void check(const Snapshot& snapshot) const;
  bool damaged(std::string what);

  std::string path_;
  EventLogReader reader_;
  recording_t head_{};
  std::optional<Simulation> simulation_;
  CommandInbox inbox_;
  StepChecksum checksum_;
  SnapshotAssembly assembly_;
  std::int64_t steps_ = 0, commands_ = 0, snapshots_ = 0;
  std::vector<std::string> bad_snapshots_;
  std::optional<std::int64_t> skipped_to_;
  std::int64_t sound_size_ = 0, sound_events_ = 0;  // before the event at hand
  std::optional<ReplayDifference> difference_;
  std::optional<LogDamage> damage_;
};

/// What the replay came to, for people; several lines.
std::string replay_text(const Replay& replay);

}  // namespace tumble
