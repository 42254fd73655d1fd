// See replay.h.
#include "replay.h"

#include <fmt/format.h>

#include <bit>
#include <stdexcept>
#include <utility>

#include "scene/sdf.h"

namespace tumble {

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

bool Replay::damaged(std::string what) {
  damage_ = {.offset = sound_size_, .cut = false, .what = std::move(what)};
  return false;
}

std::string replay_text(const Replay& replay) {
  std::string text = fmt::format("{} of {}: {} steps with {} commands came out the same", replay.head().world,
                                 replay.head().scene_name, replay.steps(), replay.commands());
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
