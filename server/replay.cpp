// See replay.h.
#include "replay.h"

#include <fmt/format.h>

#include <bit>
#include <stdexcept>
#include <utility>

#include "scene/sdf.h"
#include "version.h"

namespace tumble {
namespace {

/// Adds a part; true if the snapshot is whole with it. Throws std::runtime_error.
bool add_part(const LogEvent& event, SnapshotAssembly& assembly) {
  snapshot_t part{};
  if (const Malformed reason = decode(event.data, part); reason != Malformed::none)
    throw std::runtime_error(malformed_text(reason));
  return assembly.add(part);
}

std::string bad_snapshot_text(std::int64_t offset, const std::exception& reason) {
  return fmt::format("the snapshot at byte {} can't be used: {}", offset, reason.what());
}

}  // namespace

Replay::Replay(const std::string& path) : path_(path), reader_(path) {
  read_head();
}

void Replay::read_head() {
  const std::optional<LogEvent> first = reader_.next();
  if (!first || !first->channel.ends_with(kRecordingSuffix) ||
      decode(first->data, head_) != Malformed::none) {
    const std::string reason = reader_.damage() ? ": " + reader_.damage()->what : "";
    throw std::invalid_argument(fmt::format("{}: not a log of tumble-server --record{}", path_, reason));
  }
  sound_size_ = reader_.offset();
  sound_events_ = reader_.count();
  simulation_.emplace(build_world(read_sdf_text(head_.scene, path_, ".").scene), head_.session);
  if (std::bit_cast<std::int64_t>(simulation_->world().state_hash()) != head_.state_hash) {
    throw std::invalid_argument(
        fmt::format("{}: its scene comes out differently here; it was recorded by version {}", path_,
                    head_.server_version));
  }
}

void Replay::skip_to_last_snapshot() {
  if (head_.server_version != kVersion) return;  // which had another form of state
  const std::vector<Place> places = find_snapshots();
  for (auto place = places.rbegin(); place != places.rend() && !skipped_to_; ++place) {
    try {
      restore_at(*place);
    } catch (const std::runtime_error& error) {
      bad_snapshots_.push_back(bad_snapshot_text(place->offset, error));
    }
  }
}

std::vector<Replay::Place> Replay::find_snapshots() {
  std::vector<Place> places;
  SnapshotAssembly assembly;
  EventLogReader reader(path_);
  Place first{}, here{};
  const std::string channel = channel_name(head_.world, kSnapshotSuffix);
  for (auto event = reader.next(); event; event = reader.next()) {
    const Place start = std::exchange(here, {reader.offset(), reader.count()});
    if (event->channel != channel) continue;
    try {
      const bool whole = add_part(*event, assembly);
      if (assembly.parts() == 1) first = start;
      if (whole) places.push_back(first);
    } catch (const std::runtime_error& error) {
      bad_snapshots_.push_back(bad_snapshot_text(start.offset, error));
    }
  }
  return places;
}

void Replay::restore_at(Place place) {
  EventLogReader reader(path_);
  reader.skip_to(place.offset, place.events);
  SnapshotAssembly assembly;
  for (bool whole = false; !whole;) whole = add_part(reader.next().value(), assembly);
  const Snapshot snapshot = assembly.snapshot();
  Simulation simulation = *simulation_;
  CommandInbox inbox;
  restore(snapshot, simulation, inbox);
  simulation_ = std::move(simulation);
  inbox_ = std::move(inbox);
  sound_size_ = reader.offset();
  sound_events_ = reader.count();
  reader_.skip_to(sound_size_, sound_events_);
  skipped_to_ = snapshot.step;
}

void Replay::run(const std::function<void(const StepReport&)>& observer,
                 const volatile std::sig_atomic_t& stop) {
  const std::int64_t before = steps_;
  std::int64_t told = before;
  while (stop == 0) {
    const std::optional<LogEvent> event = reader_.next();
    if (!event) break;
    if (!replay(*event)) return;
    sound_size_ = reader_.offset();
    sound_events_ = reader_.count();
    if (steps_ != told && observer) observer(simulation_->world().report());
    told = steps_;
  }
  damage_ = reader_.damage();
}

/// False if nothing that follows can be used.
bool Replay::replay(const LogEvent& event) {
  if (event.channel == channel_name(head_.world, kForceSuffix)) return replay_command<force_command_t>(event);
  if (event.channel == channel_name(head_.world, kControlSuffix)) return replay_command<control_t>(event);
  if (event.channel == channel_name(head_.world, kStepSuffix)) return replay_step(event);
  if (event.channel == channel_name(head_.world, kSnapshotSuffix)) replay_snapshot(event);
  return true;  // pictures
}

template <typename Message>
bool Replay::replay_command(const LogEvent& event) {
  Message message{};
  if (const Malformed reason = decode(event.data, message); reason != Malformed::none) {
    return damaged(fmt::format("a command in it: {}", malformed_text(reason)));
  }
  checksum_.add_command(event.data);
  const Command command{message.client, message.sequence, message.session, message.expiry_step, message};
  inbox_.set_now(simulation_->session(), simulation_->now_step());
  if (message.start_step > simulation_->now_step()) {
    inbox_.readmit(command, message.start_step);
  } else {
    apply(command);
  }
  return true;
}

void Replay::apply(const Command& command) {
  const std::int64_t session = simulation_->session();
  inbox_.readmit(command, simulation_->now_step());
  inbox_.withdraw(command);
  inbox_.settle(command, simulation_->apply(command));
  if (simulation_->session() != session) inbox_.cancel_pending();
  inbox_.take_answers();
  ++commands_;
}

bool Replay::replay_step(const LogEvent& event) {
  step_record_t record{};
  if (const Malformed reason = decode(event.data, record); reason != Malformed::none) {
    return damaged(fmt::format("a step's record: {}", malformed_text(reason)));
  }
  if (record.commands != checksum_.commands() || record.checksum != checksum_.finish(record)) {
    return damaged(fmt::format("what it says of step {} does not fit its checksum", record.step));
  }
  checksum_ = {};
  simulation_->step();
  const std::int64_t hash = std::bit_cast<std::int64_t>(simulation_->world().state_hash());
  if (record.session != simulation_->session() || record.step != simulation_->now_step() ||
      record.state_hash != hash) {
    difference_ = {record.session, record.step, record.state_hash, hash};
    return false;
  }
  ++steps_;
  return true;
}

void Replay::replay_snapshot(const LogEvent& event) {
  if (skipped_to_) return;  // it was the last one that can be used
  try {
    if (!add_part(event, assembly_)) return;
    check(assembly_.snapshot());
    ++snapshots_;
  } catch (const std::runtime_error& error) {
    bad_snapshots_.push_back(bad_snapshot_text(sound_size_, error));
  }
}

void Replay::check(const Snapshot& snapshot) const {
  Simulation simulation = *simulation_;
  CommandInbox inbox;
  restore(snapshot, simulation, inbox);
  if (!is_same_state(take_whole_snapshot(*simulation_, inbox_), snapshot)) {
    throw std::runtime_error(
        fmt::format("it is not the state to which the commands led at step {}", simulation_->now_step()));
  }
}

bool Replay::damaged(std::string what) {
  damage_ = {.offset = sound_size_, .cut = false, .what = std::move(what)};
  return false;
}

std::string replay_text(const Replay& replay) {
  std::string text = fmt::format("{} of {}: ", replay.head().world, replay.head().scene_name);
  if (replay.skipped_to()) text += fmt::format("from the snapshot after step {} ", *replay.skipped_to());
  text += fmt::format("{} steps with {} commands came out the same", replay.steps(), replay.commands());
  if (replay.snapshots() > 0) text += fmt::format(", and {} snapshots", replay.snapshots());
  for (const std::string& sentence : replay.bad_snapshots()) text += "\n" + sentence;
  if (const auto& damage = replay.damage()) {
    text += fmt::format("\n{} at byte {}: {}; all before it was used",
                        damage->cut ? "the log ends" : "the log is damaged", damage->offset, damage->what);
  }
  if (const auto& difference = replay.difference()) {
    text += fmt::format(
        "\nstep {} of session {:x} is the first that differs: recorded hash {:016x}, here {:016x}",
        difference->step, difference->session, std::bit_cast<std::uint64_t>(difference->recorded_hash),
        std::bit_cast<std::uint64_t>(difference->hash));
  }
  return text;
}

}  // namespace tumble
