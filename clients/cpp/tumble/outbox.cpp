// Resending and answers, see outbox.h.
#include "tumble/outbox.h"

#include <algorithm>
#include <utility>

namespace tumble::client {

std::string Answer::text() const {
  if (!heard) return "no answer";
  return detail.empty() ? status_text(status) : detail;
}

void Outbox::add(std::int64_t sequence, std::string channel, std::vector<std::uint8_t> bytes,
                 Clock::time_point now) {
  queue_.emplace_back(sequence, Command{std::move(channel), std::move(bytes), now, now, 0});
}

std::vector<const Outbox::Command*> Outbox::take_due(Clock::time_point now) {
  if (std::exchange(answered_, false)) progress_ = now;
  give_up(now);
  for (; has_room(); queue_.pop_front()) {
    Command& command = sent_.insert(std::move(queue_.front())).first->second;
    command.since = command.next = now;
  }
  std::vector<const Command*> due;
  for (auto& [sequence, command] : sent_) {
    if (now < command.next) continue;
    command.next = now + timing_.resend;
    ++command.sent;
    due.push_back(&command);
  }
  return due;
}

/// The first of both in their order have the earliest ends.
void Outbox::give_up(Clock::time_point now) {
  for (; !sent_.empty() && now >= sent_.begin()->second.since + timing_.limit; sent_.erase(sent_.begin()))
    answers_[sent_.begin()->first] = Answer{};
  for (; !queue_.empty() && now >= std::max(queue_.front().second.since, progress_) + timing_.limit;
       queue_.pop_front())
    answers_[queue_.front().first] = Answer{};
}

bool Outbox::has_room() const {
  return !queue_.empty() && (sent_.empty() || queue_.front().first < sent_.begin()->first + kWindow);
}

Outbox::Clock::time_point Outbox::next_due() const {
  auto next = has_room() ? queue_.front().second.since : Clock::time_point::max();
  for (const auto& [sequence, command] : sent_)
    next = std::min({next, command.next, command.since + timing_.limit});
  return next;
}

void Outbox::receive(const ack_t& message) {
  for (std::size_t i = 0; i < message.client.size(); ++i) {
    if (message.client[i] != client_) continue;
    const std::int64_t sequence = message.sequence[i];
    const auto known = answers_.find(sequence);
    const bool only_queued =
        known != answers_.end() && known->second.heard && known->second.status == Status::queued;
    if (sent_.erase(sequence) == 0 && !only_queued) continue;  // forgotten, answered, or never ours
    answered_ = true;
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
