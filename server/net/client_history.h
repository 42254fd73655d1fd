// What each client's latest commands came to, so that a repeated one is answered again and not applied again. Bounded:
// a window of sequences per client, and the client longest unheard makes room for a new one.
#pragma once

#include <cstdint>
#include <map>

#include "net/acknowledgement.h"

namespace tumble {

class ClientHistory {
 public:
  static constexpr std::size_t kMaxClients = 256;

  enum class Novelty { fresh, repeated, too_old };

  /// Is (client, sequence > 0) new? A fresh one is entered as queued.
  Novelty enter(std::int64_t client, std::int64_t sequence);
  /// The outcome so far of a command that was entered; null once it left the window.
  Outcome* find(std::int64_t client, std::int64_t sequence);
  std::size_t size() const { return clients_.size(); }

 private:
  template <typename>
  friend struct Archived;  // its list of members, snapshot.cpp
  struct Client {
    std::uint64_t heard = 0;                   // by order of arrival
    std::map<std::int64_t, Outcome> outcomes;  // by sequence; none older than the window behind the highest
  };
  Client& find_or_make(std::int64_t client);

  std::map<std::int64_t, Client> clients_;
  std::uint64_t arrivals_ = 0;
};

}  // namespace tumble
