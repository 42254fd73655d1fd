// Reads a log that a Recorder wrote and does everything in it again: every command at its step, every step compared
// with its recorded hash. At the end stands what the server had when it died: world, clients' histories, waiting
// commands, and the place in the log from where to go on.
#pragma once

#include <csignal>
#include <functional>
#include <optional>
#include <string>

#include "net/event_log.h"
#include "simulation.h"
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

  /// To the end of what is sound, the first difference, or until `stop`; `observer` hears of every step.
  void run(const std::function<void(const StepReport&)>& observer, const volatile std::sig_atomic_t& stop);

  const recording_t& head() const { return head_; }
  std::int64_t steps() const { return steps_; }        ///< That came out the same, over all sessions.
  std::int64_t commands() const { return commands_; }  ///< That acted.
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
  void read_head();
  bool replay(const LogEvent& event);
  template <typename Message>
  bool replay_command(const LogEvent& event);
  void apply(const Command& command);
  bool replay_step(const LogEvent& event);
  bool damaged(std::string what);

  std::string path_;
  EventLogReader reader_;
  recording_t head_{};
  std::optional<Simulation> simulation_;
  CommandInbox inbox_;
  StepChecksum checksum_;
  std::int64_t steps_ = 0, commands_ = 0;
  std::int64_t sound_size_ = 0, sound_events_ = 0;  // before the event at hand
  std::optional<ReplayDifference> difference_;
  std::optional<LogDamage> damage_;
};

/// What the replay came to, for people; several lines.
std::string replay_text(const Replay& replay);

}  // namespace tumble
