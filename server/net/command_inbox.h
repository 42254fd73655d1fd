// Where commands arrive: read, checked, told apart from repetitions, held until their step and handed out in the order
// (step, client, sequence), which doesn't depend on how the network shuffled them. Every command that names its
// sender is answered; what the world says to it comes back through settle(). Memory is bounded whatever arrives.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "net/acknowledgement.h"
#include "net/client_history.h"
#include "protocol/codec.h"

namespace tumble {

/// A command whose form, session and ranges are good; whether its body exists is for the world to say.
struct Command {
  std::int64_t client = 0, sequence = 0;
  std::int64_t session = 0;      ///< 0: any
  std::int64_t expiry_step = 0;  ///< 0: never
  std::variant<force_command_t, control_t> content;
};

struct InboxCounters {
  std::uint64_t applied = 0, refused = 0, repeated = 0;
  std::array<std::uint64_t, static_cast<std::size_t>(Malformed::count)> malformed{};
  std::uint64_t nameless = 0;  ///< Client 0 or sequence < 1: nobody to answer.

  std::uint64_t damaged() const;  ///< Sum of malformed and nameless.
};

class CommandInbox {
 public:
  /// Commands in the queue up to which one that waits for a later step is accepted; one that acts at once has as much
  /// room again, so that a client with plans cannot shut out the others.
  static constexpr std::size_t kMaxWaiting = 4096;
  static constexpr std::size_t kMaxPending = 2 * kMaxWaiting;

  /// Messages received from now on are for the session and act at `step` at the earliest.
  void set_now(std::int64_t session, std::int64_t step);
  void receive_force(Bytes bytes);
  void receive_control(Bytes bytes);
  /// Another message could not be read.
  void count_malformed(Malformed reason) { ++counters_.malformed[static_cast<std::size_t>(reason)]; }

  /// `observer` hears of every command that is accepted to wait for a later step, and for which.
  void on_waiting(std::function<void(const Command&, std::int64_t start_step)> observer) {
    waiting_observer_ = std::move(observer);
  }

  /// The commands that act at the step of set_now(), in order. Each must be settled.
  std::vector<Command> take_due();
  void settle(const Command& command, Outcome outcome);
  /// Answers every waiting command with `cancelled`: the world was reset.
  void cancel_pending();

  // From a log: commands that were accepted before.
  /// Enters the command in the history and in the queue, unless it is there.
  void readmit(const Command& command, std::int64_t start_step);
  /// Takes the command out of the queue, to be settled.
  void withdraw(const Command& command);

  /// The answers since the last call, one for every copy received; call it when what was due is settled.
  std::vector<Acknowledgement> take_answers();
  const InboxCounters& counters() const { return counters_; }
  std::size_t pending() const { return pending_.size(); }

 private:
  template <typename>
  friend struct Archived;                                            // its list of members, snapshot.cpp
  using Key = std::tuple<std::int64_t, std::int64_t, std::int64_t>;  // start step, client, sequence

  template <typename Message>
  void receive(Bytes bytes);
  template <typename Message>
  void admit(const Message& message);
  void enqueue(const Command& command, std::int64_t start_step);
  void answer(std::int64_t client, std::int64_t sequence, const Outcome& outcome);
  void answer_again(std::int64_t client, std::int64_t sequence);
  void settle(std::int64_t client, std::int64_t sequence, Outcome outcome);

  std::int64_t session_ = 0, step_ = 0;
  ClientHistory history_;
  std::map<Key, Command> pending_;
  std::vector<Acknowledgement> answers_;
  std::vector<std::pair<std::int64_t, std::int64_t>> unanswered_;  // copies of commands that are due now
  InboxCounters counters_;
  std::function<void(const Command&, std::int64_t)> waiting_observer_;
};

}  // namespace tumble
