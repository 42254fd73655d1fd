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
  return clients_[client];
}

ClientHistory::Novelty ClientHistory::enter(std::int64_t client, std::int64_t sequence) {
  Client& known = find_or_make(client);
  known.heard = ++arrivals_;
  std::map<std::int64_t, Outcome>& outcomes = known.outcomes;
  // Sequences are > 0, so no difference can overflow.
  if (!outcomes.empty() && outcomes.rbegin()->first - sequence >= kSequenceWindow) return Novelty::too_old;
  if (!outcomes.try_emplace(sequence, Outcome{.status = Status::queued}).second) return Novelty::repeated;
  while (outcomes.rbegin()->first - outcomes.begin()->first >= kSequenceWindow)
    outcomes.erase(outcomes.begin());
  return Novelty::fresh;
}

Outcome* ClientHistory::find(std::int64_t client, std::int64_t sequence) {
  const auto known = clients_.find(client);
  if (known == clients_.end()) return nullptr;
  const auto entry = known->second.outcomes.find(sequence);
  return entry == known->second.outcomes.end() ? nullptr : &entry->second;
}

}  // namespace tumble
