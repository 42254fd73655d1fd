// Everything the server sends passes here, on a thread of its own, so that neither a page of copies nor a blocking
// send stalls a step. Answers, statistics and heartbeats go first; of the publications only the newest waits. Bursts
// are short and spaced, since a receiver of LCM's default settings loses all beyond 30 messages it has not read yet.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "net/clock.h"
#include "net/state_publisher.h"
#include "protocol/codec.h"

namespace tumble {

struct OutboxCounters {
  std::uint64_t frames = 0;          ///< Publications sent whole.
  std::uint64_t frames_dropped = 0;  ///< Publications replaced by a newer one before their first message.
  std::uint64_t datagrams = 0, bytes = 0;
  std::uint64_t errors = 0;  ///< Refused by the system, or dropped because too many waited.
  std::int64_t busy_ns = 0;  ///< Spent choosing, encoding and sending.
};

class Outbox {
 public:
  using Send = std::function<bool(const std::string& channel, Bytes payload)>;
  static constexpr std::int64_t kIdle = std::numeric_limits<std::int64_t>::max();
  /// A burst: its most messages, its most bytes, and the time until the next. 8000 datagrams a second at most; eight
  /// are far from the 30 a receiver keeps, two of 60 kB from the three its default buffer holds.
  static constexpr int kBurstMessages = 8;
  static constexpr std::size_t kBurstBytes = 2 * kLoopbackPayload;
  static constexpr std::int64_t kBurstNs = 1'000'000;

  /// `spread`: a publication of more than a burst is spread evenly over so long [ns], unless somebody waits for it.
  Outbox(std::string world_name, std::size_t payload_limit, Clock& clock, Send send,
         Encoding encoding = Encoding::exact, std::int64_t spread = 0);
  ~Outbox();

  /// Sends `bytes` soon. Any thread.
  void post(std::string channel, std::vector<std::uint8_t> bytes);
  /// Publishes `view` unless a newer one comes first; returns a used view to be filled again, or null. Any thread.
  std::unique_ptr<WorldView> offer(std::unique_ptr<WorldView> view);

  /// Sends what is due; returns when (now_ns) there will be more to do, kIdle if nothing waits. For callers without
  /// start(), and for the thread.
  std::int64_t pump();
  void start();  ///< Runs pump() on a thread of its own.
  void stop();   ///< Sends what still waits, for at most 0.2 s, and ends the thread.

  OutboxCounters counters() const;

 private:
  struct Message {
    std::string channel;
    std::vector<std::uint8_t> bytes;
  };
  void run();
  Message* take_message(std::int64_t now, std::int64_t& due);
  bool take_published();
  bool take_view();
  bool has_room(const Message& message, std::int64_t now);
  void send(Message& message);

  Clock& clock_;
  Send send_;
  std::int64_t spread_;

  mutable std::mutex mutex_;  // guards this block
  std::condition_variable changed_;
  std::deque<Message> urgent_;
  std::unique_ptr<WorldView> waiting_, spare_;
  OutboxCounters counters_;
  bool stopping_ = false;

  // Of the pumping thread alone.
  StatePublisher publisher_;
  std::unique_ptr<WorldView> current_;
  Message next_urgent_, next_published_;  // taken, not sent yet; without a channel: none
  std::int64_t publication_start_ = 0;    // now_ns
  std::int64_t gap_ = 0;                  // between two messages of the publication [ns]
  std::int64_t sent_of_publication_ = 0;
  std::int64_t burst_start_ = std::numeric_limits<std::int64_t>::min() / 2;
  int burst_messages_ = 0;
  std::size_t burst_bytes_ = 0;

  std::thread thread_;
};

}  // namespace tumble
