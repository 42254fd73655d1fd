// See client_history.h.
#include "net/client_history.h"

#include <algorithm>

namespace tumble {

ClientHistory::Client& ClientHistory::find_or_make(std::int64_t client) {
  const auto known = clients_.find(client);
  if (known != clients_.end()) return known->second;
  if (clients_.size() == kMaxClients) {
    clients_.erase(std::min_element(clients_.begin(), clients_.end(), [](const auto& a, const auto& b) {
      return a.second.heard < b.second.heard;
    }));
  }
  Client& added = clients_[client];
  added.window.resize(static_cast<std::size_t>(kSequenceWindow));
  return added;
}

ClientHistory::Novelty ClientHistory::enter(std::int64_t client, std::int64_t sequence) {
  Client& known = find_or_make(client);
  known.heard = ++arrivals_;
  // Both are >= 0, so the difference cannot overflow.
  if (known.highest - sequence >= kSequenceWindow) return Novelty::too_old;
  Entry& entry = known.window[static_cast<std::size_t>(sequence % kSequenceWindow)];
  if (entry.sequence == sequence) return Novelty::repeated;
  entry = {sequence, {.status = Status::queued}};
  known.highest = std::max(known.highest, sequence);
  return Novelty::fresh;
}

Outcome* ClientHistory::find(std::int64_t client, std::int64_t sequence) {
  const auto known = clients_.find(client);
  if (known == clients_.end()) return nullptr;
  Entry& entry = known->second.window[static_cast<std::size_t>(sequence % kSequenceWindow)];
  return entry.sequence == sequence ? &entry.outcome : nullptr;
}

}  // namespace tumble
