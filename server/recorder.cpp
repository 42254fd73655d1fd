// See recorder.h.
#include "recorder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "stats.h"

namespace tumble {
namespace {

/// At least one.
std::int64_t steps_of(double interval, double dt) {
  return std::max<std::int64_t>(1, std::llround(interval / dt));
}

}  // namespace

Recorder::Recorder(EventLogWriter log, const recording_t& head, const StepChecksum& checksum)
    : log_(std::move(log)),
      world_name_(head.world),
      force_channel_(channel_name(world_name_, kForceSuffix)),
      control_channel_(channel_name(world_name_, kControlSuffix)),
      step_channel_(channel_name(world_name_, kStepSuffix)),
      stats_channel_(channel_name(world_name_, kStatsSuffix)),
      snapshot_channel_(channel_name(world_name_, kSnapshotSuffix)),
      picture_steps_(steps_of(head.interval, head.dt)),
      snapshot_steps_(head.snapshot_interval > 0.0 ? steps_of(head.snapshot_interval, head.dt) : 0),
      checksum_(checksum),
      publisher_(world_name_, kLoopbackPayload) {}

Recorder::Recorder(EventLogWriter log, const recording_t& head)
    : Recorder(std::move(log), head, StepChecksum()) {
  write(head.utime, channel_name(world_name_, kRecordingSuffix), head);
  flush();
}

template <typename Message>
void Recorder::write(std::int64_t utime, const std::string& channel, const Message& message) {
  encode(message, bytes_);
  log_.write(utime, channel, bytes_);
}

void Recorder::note_command(const Command& command, std::int64_t start_step, std::int64_t session,
                            std::int64_t utime) {
  std::visit(
      [&](auto message) {
        // A session keeps a live server from obeying a log that is played to it.
        if (message.session == 0) message.session = session;
        message.start_step = start_step;
        const bool is_force = std::is_same_v<decltype(message), force_command_t>;
        write(utime, is_force ? force_channel_ : control_channel_, message);
      },
      command.content);
  checksum_.add_command(bytes_);
}

void Recorder::end_step(const Simulation& simulation, const CommandInbox& inbox, std::int64_t utime) {
  step_record_t record{};
  record.utime = utime;
  record.session = simulation.session();
  record.step = simulation.now_step();
  record.state_hash = std::bit_cast<std::int64_t>(simulation.world().state_hash());
  record.commands = checksum_.commands();
  record.checksum = checksum_.finish(record);
  write(utime, step_channel_, record);
  checksum_ = {};
  if (++since_snapshot_ == snapshot_steps_) write_snapshot(simulation, inbox, utime);
  const bool is_new = simulation.session() != view_.session;
  if (is_new || simulation.now_step() % picture_steps_ == 0) write_picture(simulation, utime);
}

void Recorder::write_snapshot(const Simulation& simulation, const CommandInbox& inbox, std::int64_t utime) {
  since_snapshot_ = 0;
  log_.finish();  // the last one is written: it can be overwritten
  take_snapshot(simulation, inbox, *snapshot_);
  log_.write_beside([snapshot = snapshot_, kept = simulation.kept(), start = simulation.start(),
                     channel = snapshot_channel_, utime](EventLogWriter& log) {
    add_kept(kept, *start, *snapshot);
    std::vector<std::uint8_t> bytes;
    send_parts(*snapshot, utime, [&](const snapshot_t& part) {
      encode(part, bytes);
      log.write(utime, channel, bytes);
    });
  });
}

void Recorder::write_picture(const Simulation& simulation, std::int64_t utime) {
  const World& world = simulation.world();
  if (!view_.catalog || simulation.session() != view_.session || world.model_epoch() != catalog_model_) {
    catalog_model_ = world.model_epoch();
    view_.catalog = make_catalog(world, ++catalog_epoch_, view_.catalog.get());
  }
  view_.utime = utime;
  view_.session = simulation.session();
  copy_world(world, {}, view_);
  publisher_.begin(view_, static_cast<std::int64_t>(world.time() * 1e9));
  std::string channel;
  while (publisher_.next(channel, bytes_)) log_.write(utime, channel, bytes_);

  stats_t stats{};
  stats.utime = utime;
  stats.session = simulation.session();
  fill_world_stats(world, simulation.start_sums(), stats);
  write(utime, stats_channel_, stats);
}

}  // namespace tumble
