// Resending and answers, see outbox.h.
#include "tumble/outbox.h"

#include <algorithm>

namespace tumble::client {

std::string Answer::text() const {
  if (!heard) return "no answer";
  std::string text = status_text(status);
  if (!detail.empty()) text += ": " + detail;
  return text;
}

void Outbox::add(std::int64_t sequence, std::string channel, std::vector<std::uint8_t> bytes,
                 Clock::time_point now) {
  waiting_[sequence] = {std::move(channel), std::move(bytes), now, now + timing_.limit, 0};
}

std::vector<const Outbox::Command*> Outbox::take_due(Clock::time_point now) {
  std::vector<const Command*> due;
  for (auto entry = waiting_.begin(); entry != waiting_.end();) {
    Command& command = entry->second;
    if (now >= command.deadline) {
      answers_[entry->first] = Answer{};
      entry = waiting_.erase(entry);
      continue;
    }
    if (now >= command.next) {
      command.next = now + timing_.resend;
      ++command.sent;
      due.push_back(&command);
    }
    ++entry;
  }
  return due;
}

Outbox::Clock::time_point Outbox::next_due() const {
  auto next = Clock::time_point::max();
  for (const auto& [sequence, command] : waiting_) next = std::min({next, command.next, command.deadline});
  return next;
}

void Outbox::receive(const ack_t& message) {
  for (std::size_t i = 0; i < message.client.size(); ++i) {
    if (message.client[i] != client_) continue;
    const std::int64_t sequence = message.sequence[i];
    const auto known = answers_.find(sequence);
    const bool only_queued =
        known != answers_.end() && known->second.heard && known->second.status == Status::queued;
    if (waiting_.erase(sequence) == 0 && !only_queued) continue;  // forgotten, answered, or never ours
    answers_[sequence] = {true,
                          static_cast<Status>(message.status[i]),
                          message.applied_step[i],
                          message.body[i],
                          message.generation[i],
                          message.detail[i]};
  }
}

const Answer* Outbox::answer(std::int64_t sequence) const {
  const auto found = answers_.find(sequence);
  return found == answers_.end() ? nullptr : &found->second;
}

void Outbox::forget(std::int64_t sequence) {
  answers_.erase(sequence);
}

}  // namespace tumble::client
