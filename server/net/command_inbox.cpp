// See command_inbox.h. A fresh command is entered in the history before anything else is said about it, so that every
// later copy gets the same answer.
#include "net/command_inbox.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "net/command_check.h"

namespace tumble {

std::uint64_t InboxCounters::damaged() const {
  return std::accumulate(malformed.begin(), malformed.end(), nameless);
}

void CommandInbox::set_now(std::int64_t session, std::int64_t step) {
  session_ = session;
  step_ = step;
}

void CommandInbox::receive_force(Bytes bytes) {
  receive<force_command_t>(bytes);
}

void CommandInbox::receive_control(Bytes bytes) {
  receive<control_t>(bytes);
}

template <typename Message>
void CommandInbox::receive(Bytes bytes) {
  Message message{};
  const Malformed reason = decode(bytes, message);
  if (reason == Malformed::none) return admit(message);
  count_malformed(reason);
  // Not entered in the history: the sound original of a damaged copy may still come.
  const Sender sender = read_sender(bytes);
  if (sender.client != 0 && sender.sequence > 0 && history_.find(sender.client, sender.sequence) == nullptr) {
    answer(sender.client, sender.sequence,
           {.status = Status::malformed,
            .detail = fmt::format("the message is damaged: {}", malformed_text(reason))});
  }
}

template <typename Message>
void CommandInbox::admit(const Message& message) {
  const std::int64_t client = message.client, sequence = message.sequence;
  if (client == 0 || sequence < 1) {
    ++counters_.nameless;
    return;
  }
  switch (history_.enter(client, sequence)) {
    case ClientHistory::Novelty::too_old:
      ++counters_.refused;
      return answer(client, sequence, {.status = Status::too_old, .detail = status_text(Status::too_old)});
    case ClientHistory::Novelty::repeated:
      ++counters_.repeated;
      return answer_again(client, sequence);
    case ClientHistory::Novelty::fresh:
      break;
  }
  const std::int64_t start = std::max(message.start_step, step_);
  Outcome outcome = check_values(message);
  if (message.session != 0 && message.session != session_) {
    outcome = {.status = Status::wrong_session,
               .detail = fmt::format("session: {} is not this one, {}", message.session, session_)};
  } else if (message.expiry_step != 0 && message.expiry_step < start) {
    outcome = {
        .status = Status::expired,
        .detail = fmt::format("expiry_step: {} is before step {}, the earliest", message.expiry_step, start)};
  } else if (outcome.status == Status::applied &&
             pending_.size() >= (start > step_ ? kMaxWaiting : kMaxPending)) {
    outcome = {.status = Status::queue_full,
               .detail = fmt::format("too many commands wait: {}", pending_.size())};
  }
  if (outcome.status != Status::applied) return settle(client, sequence, std::move(outcome));
  const Command command{client, sequence, message.session, message.expiry_step, message};
  enqueue(command, start);
  if (start == step_) return;
  answer(client, sequence, *history_.find(client, sequence));
  if (waiting_observer_) waiting_observer_(command, start);
}

void CommandInbox::enqueue(const Command& command, std::int64_t start_step) {
  pending_.emplace(Key{start_step, command.client, command.sequence}, command);
  history_.find(command.client, command.sequence)->step = start_step;
}

void CommandInbox::readmit(const Command& command, std::int64_t start_step) {
  if (history_.enter(command.client, command.sequence) == ClientHistory::Novelty::fresh)
    enqueue(command, start_step);
}

void CommandInbox::withdraw(const Command& command) {
  const Outcome* noted = history_.find(command.client, command.sequence);
  if (noted != nullptr) pending_.erase(Key{noted->step, command.client, command.sequence});
}

std::vector<Command> CommandInbox::take_due() {
  const auto end = pending_.upper_bound(
      Key{step_, std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::max()});
  std::vector<Command> due;
  for (auto it = pending_.begin(); it != end; ++it) {
    Command& command = it->second;
    if (command.expiry_step != 0 && command.expiry_step < step_) {
      settle(
          command.client, command.sequence,
          {.status = Status::expired,
           .detail = fmt::format("expiry_step: {} has passed, the step is {}", command.expiry_step, step_)});
    } else {
      due.push_back(std::move(command));
    }
  }
  pending_.erase(pending_.begin(), end);
  // Those that waited for an earlier step act now as well: one order for all.
  std::sort(due.begin(), due.end(), [](const Command& a, const Command& b) {
    return std::tie(a.client, a.sequence) < std::tie(b.client, b.sequence);
  });
  return due;
}

void CommandInbox::settle(const Command& command, Outcome outcome) {
  settle(command.client, command.sequence, std::move(outcome));
}

void CommandInbox::settle(std::int64_t client, std::int64_t sequence, Outcome outcome) {
  ++(outcome.status == Status::applied ? counters_.applied : counters_.refused);
  answer(client, sequence, outcome);
  if (Outcome* noted = history_.find(client, sequence)) *noted = std::move(outcome);
}

void CommandInbox::cancel_pending() {
  for (const auto& [key, command] : std::exchange(pending_, {})) {
    settle(command.client, command.sequence,
           {.status = Status::cancelled, .detail = status_text(Status::cancelled)});
  }
}

void CommandInbox::answer_again(std::int64_t client, std::int64_t sequence) {
  const Outcome& noted = *history_.find(client, sequence);
  if (noted.status == Status::queued && noted.step <= step_) {
    unanswered_.emplace_back(client, sequence);  // it is decided in this very tick
  } else {
    answer(client, sequence, noted);
  }
}

void CommandInbox::answer(std::int64_t client, std::int64_t sequence, const Outcome& outcome) {
  answers_.push_back({client, sequence, outcome});
}

std::vector<Acknowledgement> CommandInbox::take_answers() {
  for (const auto& [client, sequence] : std::exchange(unanswered_, {})) {
    if (const Outcome* noted = history_.find(client, sequence)) answer(client, sequence, *noted);
  }
  return std::exchange(answers_, {});
}

}  // namespace tumble
