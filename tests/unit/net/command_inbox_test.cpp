// Commands: applied exactly once whatever is repeated, in an order the network can't change, and every one answered
// with the status that fits.
#include "net/command_inbox.h"

#include <gtest/gtest.h>

#include <limits>

namespace tumble {
namespace {

constexpr std::int64_t kSession = 5000;

class Inbox : public testing::Test {
 protected:
  Inbox() { inbox_.set_now(kSession, 100); }

  static force_command_t make_force(std::int64_t client, std::int64_t sequence) {
    force_command_t c{};
    c.client = client;
    c.sequence = sequence;
    return c;
  }
  static control_t make_control(std::int64_t sequence, std::int8_t verb) {
    control_t c{};
    c.client = 1;
    c.sequence = sequence;
    c.verb = verb;
    c.orientation[0] = 1.0;
    for (double& size : c.size) size = 1.0;
    c.body_type = 1;
    c.shape_type = 1;
    return c;
  }
  void send(const force_command_t& c) {
    encode(c, bytes_);
    inbox_.receive_force(bytes_);
  }
  void send(const control_t& c) {
    encode(c, bytes_);
    inbox_.receive_control(bytes_);
  }
  /// Applies what is due at `step`; returns (client, sequence) in order.
  std::vector<std::pair<std::int64_t, std::int64_t>> run(std::int64_t step) {
    inbox_.set_now(kSession, step);
    std::vector<std::pair<std::int64_t, std::int64_t>> order;
    for (const Command& command : inbox_.take_due()) {
      order.emplace_back(command.client, command.sequence);
      inbox_.settle(command, {.step = step});
    }
    return order;
  }
  /// The only answer that waits.
  Acknowledgement only_answer() {
    const std::vector<Acknowledgement> answers = inbox_.take_answers();
    EXPECT_EQ(answers.size(), 1u);
    return answers.empty() ? Acknowledgement{} : answers.front();
  }
  template <typename Message>
  Outcome outcome_of(const Message& message) {
    send(message);
    run(100);
    return only_answer().outcome;
  }

  CommandInbox inbox_;
  std::vector<std::uint8_t> bytes_;
};

using Order = std::vector<std::pair<std::int64_t, std::int64_t>>;

TEST_F(Inbox, AppliesOnceAndAnswersEveryCopyAlike) {
  for (int i = 0; i < 3; ++i) send(make_force(1, 1));
  EXPECT_EQ(run(100), (Order{{1, 1}}));
  const std::vector<Acknowledgement> answers = inbox_.take_answers();
  ASSERT_EQ(answers.size(), 3u);
  for (const Acknowledgement& answer : answers) {
    EXPECT_EQ(answer.outcome.status, Status::applied);
    EXPECT_EQ(answer.outcome.step, 100);
  }
  inbox_.set_now(kSession, 200);
  send(make_force(1, 1));
  EXPECT_TRUE(run(200).empty());
  EXPECT_EQ(only_answer().outcome.step, 100);  // the first result, not today's
  EXPECT_EQ(inbox_.counters().applied, 1u);
  EXPECT_EQ(inbox_.counters().repeated, 3u);
}

TEST_F(Inbox, OrderIsByClientAndSequenceNotByArrival) {
  for (const auto& [client, sequence] : Order{{2, 2}, {1, 9}, {2, 1}, {1, 3}})
    send(make_force(client, sequence));
  EXPECT_EQ(run(100), (Order{{1, 3}, {1, 9}, {2, 1}, {2, 2}}));
}

TEST_F(Inbox, OneThatWaitedForTheStepHasNoPrivilege) {
  force_command_t early = make_force(7, 1);
  early.start_step = 110;
  send(early);
  inbox_.set_now(kSession, 110);
  send(make_force(3, 1));
  EXPECT_EQ(run(110), (Order{{3, 1}, {7, 1}}));
}

TEST_F(Inbox, WaitsForItsStepAndIsAnsweredTwice) {
  force_command_t c = make_force(1, 1);
  c.start_step = 120;
  send(c);
  Acknowledgement answer = only_answer();
  EXPECT_EQ(answer.outcome.status, Status::queued);
  EXPECT_EQ(answer.outcome.step, 120);
  EXPECT_TRUE(run(119).empty());
  EXPECT_EQ(run(120), (Order{{1, 1}}));
  answer = only_answer();
  EXPECT_EQ(answer.outcome.status, Status::applied);
  EXPECT_EQ(answer.outcome.step, 120);
}

TEST_F(Inbox, RefusesWithTheReason) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  force_command_t c = make_force(1, 1);
  c.force[0] = nan;
  EXPECT_EQ(outcome_of(c).status, Status::not_finite);
  c = make_force(1, 2);
  c.torque[2] = 2.0 * kMaxTorque;
  EXPECT_EQ(outcome_of(c).status, Status::out_of_range);
  c = make_force(1, 3);
  c.duration = -1.0;
  const Outcome refused = outcome_of(c);
  EXPECT_EQ(refused.status, Status::out_of_range);
  EXPECT_NE(refused.detail.find("duration: -1"), std::string::npos) << refused.detail;
  EXPECT_EQ(refused.step, -1);
  c = make_force(1, 4);
  c.frame = 2;
  EXPECT_EQ(outcome_of(c).status, Status::out_of_range);
  c = make_force(1, 5);
  c.session = kSession + 1;
  EXPECT_EQ(outcome_of(c).status, Status::wrong_session);
  c = make_force(1, 6);
  c.expiry_step = 99;
  EXPECT_EQ(outcome_of(c).status, Status::expired);
  c = make_force(1, 7);
  c.start_step = 50;
  c.expiry_step = 100;
  EXPECT_EQ(outcome_of(c).status, Status::applied);
  EXPECT_EQ(inbox_.counters().refused, 6u);
  EXPECT_EQ(inbox_.counters().applied, 1u);
}

TEST_F(Inbox, RefusesBadControls) {
  EXPECT_EQ(outcome_of(make_control(1, 0)).status, Status::unknown_verb);
  EXPECT_EQ(outcome_of(make_control(2, 99)).status, Status::unknown_verb);
  EXPECT_EQ(outcome_of(make_control(3, control_t::VERB_SPAWN)).status, Status::applied);
  control_t c = make_control(4, control_t::VERB_SPAWN);
  c.size[0] = 0.0;
  EXPECT_EQ(outcome_of(c).status, Status::out_of_range);
  c = make_control(5, control_t::VERB_SPAWN);
  c.shape_type = 77;
  EXPECT_EQ(outcome_of(c).status, Status::out_of_range);
  c = make_control(6, control_t::VERB_SPAWN);
  c.orientation[0] = 2.0;
  EXPECT_EQ(outcome_of(c).status, Status::out_of_range);
  c = make_control(7, control_t::VERB_SPAWN);
  c.mass = -1.0;
  EXPECT_EQ(outcome_of(c).status, Status::out_of_range);
  c = make_control(8, control_t::VERB_SPAWN);
  c.shape_type = 0;  // a dynamic half-space
  EXPECT_EQ(outcome_of(c).status, Status::out_of_range);
  c = make_control(11, control_t::VERB_SPAWN);
  c.shape_type = catalog_t::SHAPE_HULL;
  EXPECT_EQ(outcome_of(c).detail, "shape_type: a hull can't be spawned");
  c = make_control(9, control_t::VERB_STEP);
  c.count = 0;
  EXPECT_EQ(outcome_of(c).status, Status::out_of_range);
  c = make_control(10, control_t::VERB_PAUSE);
  c.mass = std::numeric_limits<double>::infinity();
  EXPECT_EQ(outcome_of(c).status, Status::not_finite);
}

TEST_F(Inbox, ExpiresWhileItWaits) {
  force_command_t c = make_force(1, 1);
  c.start_step = 110;
  c.expiry_step = 112;
  send(c);
  inbox_.take_answers();
  EXPECT_TRUE(run(113).empty());  // steps were skipped over
  EXPECT_EQ(only_answer().outcome.status, Status::expired);
}

TEST_F(Inbox, ResetCancelsWhatWaits) {
  force_command_t c = make_force(1, 1);
  c.start_step = 110;
  send(c);
  inbox_.take_answers();
  inbox_.cancel_pending();
  EXPECT_EQ(only_answer().outcome.status, Status::cancelled);
  EXPECT_TRUE(run(110).empty());
}

TEST_F(Inbox, TheQueueIsBounded) {
  const auto limit = static_cast<std::int64_t>(CommandInbox::kMaxWaiting);
  for (std::int64_t i = 0; i <= limit; ++i) {
    force_command_t c = make_force(1 + i % 8, 1 + i / 8);
    c.start_step = 1000;
    send(c);
  }
  const std::vector<Acknowledgement> answers = inbox_.take_answers();
  ASSERT_EQ(answers.size(), static_cast<std::size_t>(limit) + 1);
  EXPECT_EQ(answers[answers.size() - 2].outcome.status, Status::queued);
  EXPECT_EQ(answers.back().outcome.status, Status::queue_full);
  EXPECT_EQ(inbox_.pending(), CommandInbox::kMaxWaiting);
}

TEST_F(Inbox, CommandsThatWaitLeaveRoomForThoseThatActAtOnce) {
  const auto limit = static_cast<std::int64_t>(CommandInbox::kMaxWaiting);
  for (std::int64_t i = 0; i < limit; ++i) {
    force_command_t c = make_force(1, 1 + i);
    c.start_step = 1000;
    send(c);
  }
  inbox_.take_answers();
  for (std::int64_t i = 0; i <= limit; ++i) send(make_force(2, 1 + i));
  const std::vector<Acknowledgement> refused = inbox_.take_answers();
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].outcome.status, Status::queue_full);
  EXPECT_EQ(run(100).size(), static_cast<std::size_t>(limit));
}

TEST_F(Inbox, SequencesOlderThanTheWindowAreRefused) {
  send(make_force(1, 5000));
  send(make_force(1, 5000 - kSequenceWindow + 1));
  send(make_force(1, 5000 - kSequenceWindow));
  run(100);
  const std::vector<Acknowledgement> answers = inbox_.take_answers();
  ASSERT_EQ(answers.size(), 3u);
  EXPECT_EQ(answers[0].outcome.status, Status::too_old);
  EXPECT_EQ(answers[1].outcome.status, Status::applied);
  EXPECT_EQ(answers[2].outcome.status, Status::applied);
}

TEST_F(Inbox, ManyClientsAreForgottenNotKeptForever) {
  for (std::int64_t client = 1; client <= 10000; ++client) send(make_force(client, 1));
  EXPECT_LE(inbox_.pending(), CommandInbox::kMaxPending);
  ClientHistory history;
  for (std::int64_t client = 1; client <= 10000; ++client) history.enter(client, 1);
  EXPECT_EQ(history.size(), ClientHistory::kMaxClients);
}

TEST_F(Inbox, DamagedMessagesAreCountedAndAnsweredIfTheyNameASender) {
  encode(make_force(1, 1), bytes_);
  bytes_.pop_back();
  inbox_.receive_force(bytes_);
  EXPECT_EQ(only_answer().outcome.status, Status::malformed);
  bytes_[0] ^= 1;
  inbox_.receive_force(bytes_);
  EXPECT_TRUE(inbox_.take_answers().empty());
  send(make_force(0, 1));  // names nobody
  EXPECT_TRUE(inbox_.take_answers().empty());
  EXPECT_EQ(inbox_.counters().malformed[static_cast<std::size_t>(Malformed::too_short)], 1u);
  EXPECT_EQ(inbox_.counters().malformed[static_cast<std::size_t>(Malformed::wrong_fingerprint)], 1u);
  EXPECT_EQ(inbox_.counters().nameless, 1u);
  EXPECT_EQ(inbox_.counters().damaged(), 3u);
  // The sound original is new all the same.
  EXPECT_EQ(outcome_of(make_force(1, 1)).status, Status::applied);
}

}  // namespace
}  // namespace tumble
