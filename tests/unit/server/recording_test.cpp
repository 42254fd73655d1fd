// A recorded run, read again in the same process: same bits, same answers, and what waited waits again.
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "recorder.h"
#include "replay.h"
#include "scene/demo.h"
#include "scene/sdf.h"
#include "version.h"

namespace tumble {
namespace {

constexpr std::int64_t kSession = 65537;
constexpr int kSnapshotSteps = 10;

class Recording : public testing::Test {
 protected:
  Recording() : simulation_(build_world(scene()), kSession) {
    std::filesystem::remove(path_);
    recording_t head{};
    head.session = kSession;
    head.world = "T";
    head.dt = scene().options.time_step;
    head.server_version = kVersion;
    head.interval = 0.1;
    head.snapshot_interval = kSnapshotSteps * head.dt;
    head.scene = write_sdf(scene());
    head.state_hash = static_cast<std::int64_t>(simulation_.world().state_hash());
    recorder_.emplace(EventLogWriter(path_), head);
  }
  ~Recording() override { std::filesystem::remove(path_); }

  static Scene scene() { return read_sdf_text(std::string(demo_text("cradle")), "cradle", ".").scene; }
  void step(int count) {
    for (int i = 0; i < count; ++i) {
      simulation_.step();
      recorder_->end_step(simulation_, inbox_, 1000 * ++utime_);
    }
  }
  static Command make_push(std::int64_t sequence, std::uint32_t body) {
    force_command_t push{};
    push.client = 7;
    push.sequence = sequence;
    push.body = static_cast<std::int32_t>(body);
    push.generation = 1;
    push.force[0] = 0.25;
    push.duration = 0.02;
    return {7, sequence, 0, 0, push};
  }
  static Command make_control(std::int64_t sequence, std::int8_t verb, const std::string& name = "") {
    control_t control{};
    control.client = 7;
    control.sequence = sequence;
    control.verb = verb;
    control.count = 1;
    control.name = name;
    return {7, sequence, 0, 0, control};
  }
  Outcome apply(const Command& command) {
    recorder_->note_command(command, simulation_.now_step(), simulation_.session(), 1000 * utime_);
    return simulation_.apply(command);
  }
  Replay replay() {
    recorder_->finish();
    Replay replay(path_);
    const volatile std::sig_atomic_t stop = 0;
    replay.run({}, stop);
    return replay;
  }
  /// Goes on from the last snapshot.
  Replay resume() {
    recorder_->finish();
    Replay replay(path_);
    replay.skip_to_last_snapshot();
    const volatile std::sig_atomic_t stop = 0;
    replay.run({}, stop);
    return replay;
  }
  /// Appends to the log that was replayed until the simulation is at this step.
  void go_on(Replay& replayed, std::int64_t until) const {
    Recorder recorder(EventLogWriter(path_, replayed.log_size(), replayed.log_events()), replayed.head(),
                      replayed.checksum());
    while (replayed.simulation().now_step() < until) {
      replayed.simulation().step();
      recorder.end_step(replayed.simulation(), replayed.inbox(), 0);
    }
    recorder.finish();
  }
  std::string read_log() {
    recorder_->finish();
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  std::uint32_t moving_body() const {
    std::uint32_t slot = 0;
    while (simulation_.world().body(slot).type != BodyType::dynamic) ++slot;
    return slot;
  }

  std::string path_ = testing::TempDir() + "recording_" + std::to_string(::getpid()) + ".lcm";
  Simulation simulation_;
  CommandInbox inbox_;
  std::optional<Recorder> recorder_;
  std::int64_t utime_ = 0;
};

TEST_F(Recording, ComesOutTheSame) {
  step(20);
  EXPECT_EQ(apply(make_push(1, moving_body())).status, Status::applied);
  EXPECT_EQ(apply(make_push(2, 999)).status, Status::unknown_body);
  step(20);
  EXPECT_EQ(apply(make_control(3, control_t::VERB_SNAPSHOT, "a")).status, Status::applied);
  step(20);
  EXPECT_EQ(apply(make_control(4, control_t::VERB_RESTORE, "a")).status, Status::applied);
  step(20);
  EXPECT_EQ(apply(make_control(5, control_t::VERB_RESTORE, "b")).status, Status::invalid);
  EXPECT_EQ(apply(make_control(6, control_t::VERB_RESET)).status, Status::applied);
  EXPECT_EQ(apply(make_push(8, moving_body())).status, Status::applied)
      << "of the same tick, for any session";
  Command late = make_push(9, moving_body());
  late.session = std::get<force_command_t>(late.content).session = kSession;
  EXPECT_EQ(apply(late).status, Status::wrong_session);
  step(20);
  EXPECT_EQ(apply(make_control(7, control_t::VERB_PAUSE)).status, Status::applied);
  Replay again = replay();
  EXPECT_FALSE(again.difference());
  EXPECT_FALSE(again.damage());
  EXPECT_EQ(again.steps(), 100);
  EXPECT_EQ(again.snapshots(), 100 / kSnapshotSteps);
  EXPECT_TRUE(again.bad_snapshots().empty());
  EXPECT_EQ(again.commands(), 9);
  EXPECT_EQ(again.simulation().world().state_hash(), simulation_.world().state_hash());
  EXPECT_EQ(again.simulation().session(), kSession + 2);
  EXPECT_TRUE(again.simulation().paused());
}

TEST_F(Recording, GivesBackAnswersAndWhatWaited) {
  step(5);
  apply(make_push(1, moving_body()));
  recorder_->note_command(make_push(2, moving_body()), 40, kSession, 0);  // accepted to wait
  step(5);
  Replay again = replay();
  CommandInbox& inbox = again.inbox();
  EXPECT_EQ(inbox.pending(), 1u);
  inbox.set_now(kSession, 10);
  for (const std::int64_t sequence : {1, 2}) {
    std::vector<std::uint8_t> bytes;
    encode(std::get<force_command_t>(make_push(sequence, moving_body()).content), bytes);
    inbox.receive_force(bytes);
  }
  const std::vector<Acknowledgement> answers = inbox.take_answers();
  ASSERT_EQ(answers.size(), 2u);
  EXPECT_EQ(answers[0].outcome.status, Status::applied);
  EXPECT_EQ(answers[0].outcome.step, 5);
  EXPECT_EQ(answers[1].outcome.status, Status::queued);
  EXPECT_EQ(answers[1].outcome.step, 40);
  EXPECT_EQ(inbox.counters().repeated, 2u);
}

TEST_F(Recording, NamesTheFirstStepThatDiffers) {
  step(30);
  simulation_.apply(make_push(1, moving_body()));  // not recorded
  step(30);
  const Replay again = replay();
  ASSERT_TRUE(again.difference());
  EXPECT_EQ(again.difference()->step, 31);
  EXPECT_EQ(again.steps(), 30);
}

TEST_F(Recording, GoesOnAfterACutAtAnyByte) {
  step(3);
  apply(make_push(1, moving_body()));
  step(2);
  const std::string bytes = read_log();
  const volatile std::sig_atomic_t stop = 0;
  for (std::size_t length = bytes.size() - 600; length < bytes.size(); length += 7) {  // the last steps
    std::ofstream(path_, std::ios::binary) << bytes.substr(0, length);
    Replay cut(path_);
    cut.run({}, stop);
    EXPECT_FALSE(cut.difference());
    EXPECT_TRUE(!cut.damage() || cut.damage()->cut) << cut.damage()->what;
    go_on(cut, 8);
    Replay again(path_);
    again.run({}, stop);
    EXPECT_FALSE(again.difference() || again.damage()) << length;
    EXPECT_EQ(again.simulation().now_step(), 8);
  }
}

TEST_F(Recording, GoesOnFromTheLastSnapshot) {
  step(15);
  apply(make_push(1, moving_body()));
  apply(make_control(2, control_t::VERB_SNAPSHOT, "kept"));
  apply(make_control(3, control_t::VERB_CONTACTS_ON));
  step(8);
  apply(make_push(4, moving_body()));
  step(4);
  Replay again = resume();
  EXPECT_EQ(again.skipped_to(), 20);
  EXPECT_EQ(again.steps(), 7);
  EXPECT_EQ(again.commands(), 1);
  EXPECT_TRUE(again.bad_snapshots().empty());
  EXPECT_TRUE(again.simulation().contacts_wanted());
  EXPECT_EQ(again.simulation().view_pushes().size(), simulation_.view_pushes().size());
  const auto expect_equal = [&] {
    EXPECT_TRUE(
        is_same_state(take_whole_snapshot(again.simulation(), {}), take_whole_snapshot(simulation_, {})));
  };
  expect_equal();
  for (const auto& command : {make_control(5, control_t::VERB_RESTORE, "kept"), make_push(6, moving_body()),
                              make_control(7, control_t::VERB_RESET)}) {
    EXPECT_EQ(again.simulation().apply(command).status, Status::applied);
    EXPECT_EQ(simulation_.apply(command).status, Status::applied);
    for (int i = 0; i < 200; ++i) {
      again.simulation().step();
      simulation_.step();
    }
    expect_equal();
  }
}

TEST_F(Recording, KeepsAnswersAndWhatWaitedInSnapshots) {
  step(3);
  apply(make_push(1, moving_body()));
  recorder_->note_command(make_push(2, moving_body()), 40, kSession, 0);
  step(2);
  Replay before = replay();
  go_on(before, before.simulation().now_step() + kSnapshotSteps);
  Replay again = resume();
  EXPECT_EQ(again.skipped_to(), 15);
  EXPECT_EQ(again.inbox().pending(), 1u);
  again.inbox().set_now(kSession, 15);
  std::vector<std::uint8_t> bytes;
  encode(std::get<force_command_t>(make_push(1, moving_body()).content), bytes);
  again.inbox().receive_force(bytes);
  const std::vector<Acknowledgement> answers = again.inbox().take_answers();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].outcome.step, 3) << "as it was told before, and not applied again";
  again.inbox().set_now(kSession, 40);
  const std::vector<Command> due = again.inbox().take_due();
  ASSERT_EQ(due.size(), 1u);
  EXPECT_EQ(std::get<force_command_t>(due[0].content).force[0], 0.25);
}

TEST_F(Recording, TakesTheSnapshotBeforeADamagedOne) {
  step(35);
  std::string bytes = read_log();
  bytes[bytes.rfind("T_SNAPSHOT") + 5000] ^= 4;
  std::ofstream(path_, std::ios::binary) << bytes;
  Replay again = resume();
  EXPECT_EQ(again.skipped_to(), 20);
  EXPECT_EQ(again.steps(), 15);
  EXPECT_FALSE(again.difference() || again.damage());
  EXPECT_EQ(again.simulation().world().state_hash(), simulation_.world().state_hash());
  ASSERT_EQ(again.bad_snapshots().size(), 1u);
  EXPECT_NE(again.bad_snapshots()[0].find("after step 30 is damaged"), std::string::npos);
  EXPECT_EQ(replay().bad_snapshots().size(), 1u);
  EXPECT_EQ(replay().snapshots(), 2);
}

TEST_F(Recording, TellsASnapshotThatIsNotWhatTheCommandsLedTo) {
  step(5);
  Simulation other = simulation_;  // the same world, but for what its next steps do
  other.apply(make_push(1, moving_body()));
  const Replay before = replay();
  EventLogWriter log(path_, before.log_size(), before.log_events());
  send_parts(take_whole_snapshot(other, inbox_), 0, [&](const snapshot_t& part) {
    std::vector<std::uint8_t> bytes;
    encode(part, bytes);
    log.write(0, "T_SNAPSHOT", bytes);
  });
  log.flush();
  const Replay again = replay();
  EXPECT_FALSE(again.difference() || again.damage());
  EXPECT_EQ(again.snapshots(), 0);
  ASSERT_EQ(again.bad_snapshots().size(), 1u);
  EXPECT_NE(again.bad_snapshots()[0].find("commands led at step 5"), std::string::npos);
}

TEST_F(Recording, GoesOnAfterACutWithinASnapshot) {
  step(2 * kSnapshotSteps);
  const std::string bytes = read_log();
  const std::size_t last = bytes.rfind("T_SNAPSHOT") - 28;
  const volatile std::sig_atomic_t stop = 0;
  for (std::size_t length = last; length < bytes.size(); length += 997) {
    std::ofstream(path_, std::ios::binary) << bytes.substr(0, length);
    Replay cut = resume();
    EXPECT_EQ(cut.skipped_to(), kSnapshotSteps);
    EXPECT_EQ(cut.steps(), kSnapshotSteps);
    EXPECT_TRUE(cut.bad_snapshots().empty());
    go_on(cut, cut.simulation().now_step() + kSnapshotSteps);
    Replay again(path_);
    again.run({}, stop);
    EXPECT_FALSE(again.difference() || again.damage()) << length;
    EXPECT_EQ(again.snapshots(), 2);
    EXPECT_TRUE(again.bad_snapshots().empty());
  }
}

}  // namespace
}  // namespace tumble
