// See outbox.h.
#include "net/outbox.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <utility>

namespace tumble {
namespace {

constexpr std::size_t kMaxUrgent = 4096;  // messages; more than a second of answers at full pace
constexpr std::int64_t kStopNs = 200'000'000;

}  // namespace

Outbox::Outbox(std::string world_name, std::size_t payload_limit, Clock& clock, Send send, Encoding encoding,
               std::int64_t spread)
    : clock_(clock),
      send_(std::move(send)),
      spread_(spread),
      publisher_(std::move(world_name), payload_limit, encoding) {}

Outbox::~Outbox() {
  stop();
}

void Outbox::post(std::string channel, std::vector<std::uint8_t> bytes) {
  {
    const std::lock_guard lock(mutex_);
    if (urgent_.size() == kMaxUrgent) {
      urgent_.pop_front();
      ++counters_.errors;
    }
    urgent_.push_back({std::move(channel), std::move(bytes)});
  }
  changed_.notify_one();
}

std::unique_ptr<WorldView> Outbox::offer(std::unique_ptr<WorldView> view) {
  std::unique_ptr<WorldView> used;
  {
    const std::lock_guard lock(mutex_);
    used = std::exchange(waiting_, std::move(view));
    if (used) {
      ++counters_.frames_dropped;
    } else {
      used = std::move(spare_);
    }
  }
  changed_.notify_one();
  return used;
}

std::int64_t Outbox::pump() {
  const std::int64_t start = clock_.now_ns();
  std::int64_t now = start, due = kIdle;
  while (Message* message = take_message(now, due)) {
    if (!has_room(*message, now)) {
      due = burst_start_ + kBurstNs;
      break;
    }
    send(*message);
    now = clock_.now_ns();
  }
  const std::lock_guard lock(mutex_);
  counters_.busy_ns += clock_.now_ns() - start;
  return due;
}

/// The message to send now: an urgent one, or the publication's next if it is its time. Null: none before `due`.
Outbox::Message* Outbox::take_message(std::int64_t now, std::int64_t& due) {
  if (next_urgent_.channel.empty()) {
    const std::lock_guard lock(mutex_);
    if (!urgent_.empty()) {
      next_urgent_ = std::move(urgent_.front());
      urgent_.pop_front();
    }
  }
  if (!next_urgent_.channel.empty()) return &next_urgent_;
  if (next_published_.channel.empty() && !take_published()) return nullptr;
  const std::int64_t when = publication_start_ + sent_of_publication_ * gap_ / kBurstNs * kBurstNs;
  if (now >= when) return &next_published_;
  due = when;
  return nullptr;
}

/// Encodes the publication's next message; false: there is none.
bool Outbox::take_published() {
  while (current_ || take_view()) {
    if (publisher_.next(next_published_.channel, next_published_.bytes)) return true;
    const std::lock_guard lock(mutex_);
    ++counters_.frames;
    spare_ = std::move(current_);
  }
  return false;
}

bool Outbox::take_view() {
  {
    const std::lock_guard lock(mutex_);
    current_ = std::move(waiting_);
  }
  if (!current_) return false;
  publication_start_ = clock_.now_ns();
  sent_of_publication_ = 0;
  publisher_.begin(*current_, publication_start_);
  const auto count = static_cast<std::int64_t>(publisher_.count());
  gap_ = count > kBurstMessages && !current_->at_once ? spread_ / count : 0;
  return true;
}

/// Whether the message fits the burst; starts a new one when it is time.
bool Outbox::has_room(const Message& message, std::int64_t now) {
  if (now >= burst_start_ + kBurstNs) {
    burst_start_ = now;
    burst_messages_ = 0;
    burst_bytes_ = 0;
  }
  return burst_messages_ < kBurstMessages &&
         (burst_messages_ == 0 || burst_bytes_ + message.bytes.size() <= kBurstBytes);
}

void Outbox::send(Message& message) {
  const bool sent = send_(message.channel, message.bytes);
  ++burst_messages_;
  burst_bytes_ += message.bytes.size();
  if (&message == &next_published_) ++sent_of_publication_;
  const std::lock_guard lock(mutex_);
  if (sent) {
    ++counters_.datagrams;
    counters_.bytes += message.bytes.size();
  } else {
    ++counters_.errors;
  }
  message.channel.clear();
}

void Outbox::start() {
  stopping_ = false;
  // Signals are for the thread that started this one: they must end its sleep.
  sigset_t all, kept;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_BLOCK, &all, &kept);
  thread_ = std::thread([this] { run(); });
  ::pthread_sigmask(SIG_SETMASK, &kept, nullptr);
}

void Outbox::stop() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void Outbox::run() {
  std::int64_t give_up = kIdle;
  while (true) {
    const std::int64_t due = pump();
    std::unique_lock lock(mutex_);
    if (stopping_) {
      give_up = std::min(give_up, clock_.now_ns() + kStopNs);
      if (due == kIdle || clock_.now_ns() >= give_up) return;
    }
    if (due == kIdle) {
      changed_.wait(lock, [this] { return stopping_ || !urgent_.empty() || waiting_; });
    } else if (!urgent_.empty() || stopping_) {  // the burst is full
      lock.unlock();
      clock_.sleep_until(due);
    } else {
      const std::chrono::nanoseconds wait(due - clock_.now_ns());
      changed_.wait_for(lock, wait, [this] { return stopping_ || !urgent_.empty(); });
    }
  }
}

OutboxCounters Outbox::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace tumble
