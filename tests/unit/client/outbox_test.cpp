// Commands are repeated until they are answered or their time is up, on a clock made of numbers.
#include "tumble/outbox.h"

#include <gtest/gtest.h>

namespace tumble::client {
namespace {

using std::chrono::milliseconds;

Outbox::Clock::time_point at(int ms) {
  return Outbox::Clock::time_point(milliseconds(ms));
}

ack_t make_ack(std::int64_t client, std::int64_t sequence, Status status, const std::string& detail = "") {
  ack_t message{};
  message.n = 1;
  message.client = {client};
  message.sequence = {sequence};
  message.status = {static_cast<std::int8_t>(status)};
  message.applied_step = {7};
  message.body = {3};
  message.generation = {0};
  message.detail = {detail};
  return message;
}

class OutboxTest : public testing::Test {
 protected:
  Outbox outbox{42, Outbox::Timing{}};
};

TEST_F(OutboxTest, SendsAtOnceThenEvery50MsUntilAnswered) {
  outbox.add(1, "W_FORCE", {1, 2, 3}, at(1000));
  std::vector<int> times;
  for (int ms = 1000; ms < 1200; ++ms) {
    for (const Outbox::Command* command : outbox.take_due(at(ms))) {
      EXPECT_EQ(command->channel, "W_FORCE");
      EXPECT_EQ(command->bytes, (std::vector<std::uint8_t>{1, 2, 3}));
      times.push_back(ms);
    }
  }
  EXPECT_EQ(times, (std::vector<int>{1000, 1050, 1100, 1150}));
  outbox.receive(make_ack(42, 1, Status::applied));
  EXPECT_TRUE(outbox.take_due(at(1200)).empty());
  ASSERT_NE(outbox.answer(1), nullptr);
  EXPECT_TRUE(outbox.answer(1)->accepted());
  EXPECT_EQ(outbox.answer(1)->step, 7);
}

TEST_F(OutboxTest, GivesUpAfterTheLimit) {
  outbox.add(1, "W_FORCE", {1}, at(0));
  EXPECT_EQ(outbox.take_due(at(0)).size(), 1u);
  EXPECT_EQ(outbox.take_due(at(1999)).size(), 1u);
  EXPECT_EQ(outbox.answer(1), nullptr);
  EXPECT_TRUE(outbox.take_due(at(2000)).empty());
  ASSERT_NE(outbox.answer(1), nullptr);
  EXPECT_FALSE(outbox.answer(1)->heard);
  EXPECT_FALSE(outbox.answer(1)->accepted());
  EXPECT_EQ(outbox.waiting(), 0u);
}

TEST_F(OutboxTest, SaysWhenItWantsToBeAskedAgain) {
  EXPECT_EQ(outbox.next_due(), Outbox::Clock::time_point::max());
  outbox.add(1, "W_FORCE", {1}, at(100));
  EXPECT_EQ(outbox.next_due(), at(100));
  outbox.take_due(at(100));
  EXPECT_EQ(outbox.next_due(), at(150));
}

TEST_F(OutboxTest, KeepsTheServersReason) {
  outbox.add(1, "W_FORCE", {1}, at(0));
  outbox.take_due(at(0));
  outbox.receive(make_ack(42, 1, Status::unknown_body, "index 99, the world has 3"));
  EXPECT_FALSE(outbox.answer(1)->accepted());
  EXPECT_EQ(outbox.answer(1)->text(), "index 99, the world has 3") << "one sentence";
}

TEST_F(OutboxTest, IgnoresAnswersToOthersAndRepeatedOnes) {
  outbox.add(1, "W_FORCE", {1}, at(0));
  outbox.take_due(at(0));
  outbox.receive(make_ack(43, 1, Status::applied));
  outbox.receive(make_ack(42, 2, Status::applied));
  EXPECT_EQ(outbox.answer(1), nullptr);
  EXPECT_EQ(outbox.answer(2), nullptr);
  outbox.receive(make_ack(42, 1, Status::applied));
  outbox.receive(make_ack(42, 1, Status::expired));
  EXPECT_EQ(outbox.answer(1)->status, Status::applied);
}

TEST_F(OutboxTest, AnAnswerAfterQueuedReplacesIt) {
  outbox.add(1, "W_FORCE", {1}, at(0));
  outbox.take_due(at(0));
  outbox.receive(make_ack(42, 1, Status::queued));
  EXPECT_TRUE(outbox.answer(1)->accepted());
  EXPECT_TRUE(outbox.take_due(at(500)).empty());
  outbox.receive(make_ack(42, 1, Status::cancelled));
  EXPECT_EQ(outbox.answer(1)->status, Status::cancelled);
}

TEST_F(OutboxTest, PicksItsAnswersOutOfAFullMessage) {
  outbox.add(5, "W_FORCE", {1}, at(0));
  outbox.add(6, "W_CONTROL", {2}, at(0));
  outbox.take_due(at(0));
  ack_t message = make_ack(9, 5, Status::invalid);
  const ack_t own = make_ack(42, 6, Status::applied);
  message.n = 2;
  message.client.push_back(own.client[0]);
  message.sequence.push_back(own.sequence[0]);
  message.status.push_back(own.status[0]);
  message.applied_step.push_back(123);
  message.body.push_back(-1);
  message.generation.push_back(-1);
  message.detail.push_back("");
  outbox.receive(message);
  EXPECT_EQ(outbox.answer(5), nullptr);
  ASSERT_NE(outbox.answer(6), nullptr);
  EXPECT_EQ(outbox.answer(6)->step, 123);
}

// A server that remembers kSequenceWindow numbers of a client must not forget one that is still on its way.
TEST_F(OutboxTest, ManyCommandsTakeTurns) {
  const std::int64_t count = 3 * Outbox::kWindow;
  for (std::int64_t sequence = 1; sequence <= count; ++sequence) outbox.add(sequence, "W_FORCE", {1}, at(0));
  EXPECT_EQ(outbox.take_due(at(0)).size(), static_cast<std::size_t>(Outbox::kWindow));
  for (std::int64_t sequence = 2; sequence <= Outbox::kWindow; ++sequence)
    outbox.receive(make_ack(42, sequence, Status::applied));
  EXPECT_TRUE(outbox.take_due(at(10)).empty()) << "the first was lost, the window has not moved";
  EXPECT_EQ(outbox.take_due(at(50)).size(), 1u);
  outbox.receive(make_ack(42, 1, Status::applied));
  EXPECT_EQ(outbox.take_due(at(60)).size(), static_cast<std::size_t>(Outbox::kWindow));
}

TEST_F(OutboxTest, AllThatWaitAreGivenUpTogetherWhenTheServerIsSilent) {
  const std::int64_t count = 3 * Outbox::kWindow;
  for (std::int64_t sequence = 1; sequence <= count; ++sequence) outbox.add(sequence, "W_FORCE", {1}, at(0));
  outbox.take_due(at(0));
  outbox.receive(make_ack(42, 1, Status::applied));  // the last that is heard of the server
  EXPECT_EQ(outbox.take_due(at(1500)).size(), static_cast<std::size_t>(Outbox::kWindow));
  EXPECT_EQ(outbox.take_due(at(2000)).size(), static_cast<std::size_t>(Outbox::kWindow)) << "a second window";
  outbox.take_due(at(3500));
  ASSERT_NE(outbox.answer(count), nullptr) << "the third is given up: 2 s of silence";
  EXPECT_FALSE(outbox.answer(count)->heard);
  outbox.take_due(at(4000));
  EXPECT_EQ(outbox.waiting(), 0u);
}

TEST_F(OutboxTest, SequencesRise) {
  EXPECT_EQ(outbox.next_sequence(), 1);
  EXPECT_EQ(outbox.next_sequence(), 2);
}

}  // namespace
}  // namespace tumble::client
