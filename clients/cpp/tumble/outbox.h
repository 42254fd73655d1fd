// Commands on their way: each is sent again until the server answers or its time is up. The server applies a
// (client, sequence) once however often it arrives, so repeating is safe. Knows no clock and no network: the caller
// says what time it is and puts the bytes on the wire.
// Only a window of numbers is on the wire at a time, the others wait for their turn: so ten thousand commands given at
// once neither flood the server nor leave its memory of numbers before they are answered.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "protocol/channels.h"
#include "tumble/ack_t.hpp"

namespace tumble::client {

/// What the server made of a command.
struct Answer {
  bool heard = false;  ///< False: no answer within the time limit; it may have been applied all the same.
  Status status = Status::applied;
  std::int64_t step = -1;  ///< First step it acts in; -1 if refused.
  std::int32_t body = -1;  ///< The body it was about, the new one for a spawn.
  std::int32_t generation = -1;
  std::string detail;  ///< The server's reason, for people.

  /// Applied, or queued for its start step.
  bool accepted() const { return heard && (status == Status::applied || status == Status::queued); }
  /// One sentence: the server's reason, or else the status in words.
  std::string text() const;
};

class Outbox {
 public:
  using Clock = std::chrono::steady_clock;
  struct Timing {
    Clock::duration resend = std::chrono::milliseconds(50);
    /// A command is given up so long after it went out first; or before, if the server has been silent for so long.
    Clock::duration limit = std::chrono::seconds(2);
  };
  struct Command {
    std::string channel;
    std::vector<std::uint8_t> bytes;
    Clock::time_point since;  ///< When it went out first; until then, when it was given to the outbox.
    Clock::time_point next;   ///< When it goes out next.
    int sent = 0;             ///< Times it went out.
  };

  /// Largest span of numbers on the wire: a quarter of those that a server remembers of a client.
  static constexpr std::int64_t kWindow = kSequenceWindow / 4;

  Outbox(std::int64_t client, Timing timing) : client_(client), timing_(timing) {}

  std::int64_t client() const { return client_; }
  /// Number for the next command, rising from 1.
  std::int64_t next_sequence() { return ++sequence_; }
  /// Takes over a command; it is due at once, or when its turn comes.
  void add(std::int64_t sequence, std::string channel, std::vector<std::uint8_t> bytes,
           Clock::time_point now);
  /// Commands to put on the wire now, oldest first. Those whose time is up are given up: answered as not heard.
  std::vector<const Command*> take_due(Clock::time_point now);
  /// When take_due has something to do next; time_point::max() if nothing waits.
  Clock::time_point next_due() const;
  /// Picks out the answers to this client's commands. An answer after `queued` replaces it.
  void receive(const ack_t& message);
  /// The answer, or null while the command waits. Answers are kept until `forget`.
  const Answer* answer(std::int64_t sequence) const;
  void forget(std::int64_t sequence);
  std::size_t waiting() const { return sent_.size() + queue_.size(); }

 private:
  void give_up(Clock::time_point now);
  /// Whether the first of the queue may go out.
  bool has_room() const;

  std::int64_t client_;
  Timing timing_;
  std::int64_t sequence_ = 0;
  std::map<std::int64_t, Command> sent_;                ///< On the wire.
  std::deque<std::pair<std::int64_t, Command>> queue_;  ///< Wait for their turn.
  bool answered_ = false;                               ///< Since take_due.
  Clock::time_point progress_;                          ///< When answers were seen last.
  std::map<std::int64_t, Answer> answers_;
};

}  // namespace tumble::client
