// Writes a run to a log from which it can be repeated to the bit: the scene, every command with the step at which it
// acts, after each step the hash of the world, at an interval a picture of it (catalogue, states, statistics) for everyone
// who reads LCM logs, and at a longer one a snapshot of the whole inner state, of which the step does no more than the
// copy. Commands are written before they are answered, so that nothing accepted is ever lost.
#pragma once

#include <memory>
#include <string>

#include "net/ordered_log.h"
#include "net/state_publisher.h"
#include "simulation.h"
#include "snapshot.h"
#include "step_checksum.h"
#include "tumble/recording_t.hpp"

namespace tumble {

/// Everything throws std::system_error if the file can't take it.
class Recorder {
 public:
  /// Goes on with a log whose events since the last step record are summed up in `checksum`. `head` stands in the log.
  Recorder(EventLogWriter log, const recording_t& head, const StepChecksum& checksum);
  /// Starts a log: writes `head`.
  Recorder(EventLogWriter log, const recording_t& head);

  /// `command` acts at `start_step`: a later step than now if it was accepted to wait, or now. `session` is the present
  /// one.
  void note_command(const Command& command, std::int64_t start_step, std::int64_t session,
                    std::int64_t utime);
  /// `inbox`: every answer has been taken out of it.
  void end_step(const Simulation& simulation, const CommandInbox& inbox, std::int64_t utime);
  /// True: what was noted outlives the process from here on. False: a snapshot is being written; ask again.
  bool flush() { return log_.flush(); }
  /// Waits until that is so.
  void finish() { log_.finish(); }

 private:
  template <typename Message>
  void write(std::int64_t utime, const std::string& channel, const Message& message);
  void write_picture(const Simulation& simulation, std::int64_t utime);
  void write_snapshot(const Simulation& simulation, const CommandInbox& inbox, std::int64_t utime);

  OrderedLog log_;
  std::string world_name_, force_channel_, control_channel_, step_channel_, stats_channel_, snapshot_channel_;
  std::int64_t picture_steps_;       // between two pictures
  std::int64_t snapshot_steps_;      // between two snapshots; 0: none
  std::int64_t since_snapshot_ = 0;  // steps
  std::shared_ptr<Snapshot> snapshot_ =
      std::make_shared<Snapshot>();  // the last one; its memory for the next
  StepChecksum checksum_;
  StatePublisher publisher_;
  WorldView view_;
  std::uint64_t catalog_model_ = 0;
  std::int64_t catalog_epoch_ = 0;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace tumble
