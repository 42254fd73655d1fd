// See outbox.h.
#include "net/outbox.h"

#include <signal.h>

#include <algorithm>
#include <utility>

namespace tumble {
namespace {

constexpr std::size_t kMaxUrgent = 4096;  // messages; more than a second of answers at full pace
constexpr std::int64_t kStopNs = 200'000'000;

}  // namespace

Outbox::Outbox(std::string world_name, std::size_t payload_limit, Clock& clock, Send send)
    : clock_(clock), send_(std::move(send)), publisher_(std::move(world_name), payload_limit) {}

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
  while (take_next()) {
    const bool over = burst_messages_ >= kBurstMessages || burst_bytes_ + next_.bytes.size() > kBurstBytes;
    if (over || now >= burst_start_ + kBurstNs) {
      if (now < burst_start_ + kBurstNs) {
        due = burst_start_ + kBurstNs;
        break;
      }
      burst_start_ = now;
      burst_messages_ = 0;
      burst_bytes_ = 0;
    }
    send_next();
    now = clock_.now_ns();
  }
  const std::lock_guard lock(mutex_);
  counters_.busy_ns += clock_.now_ns() - start;
  return due;
}

/// Makes `next_` the message to send: the one that waits already, an urgent one, or the publication's next.
bool Outbox::take_next() {
  if (!next_.channel.empty()) return true;
  {
    const std::lock_guard lock(mutex_);
    if (!urgent_.empty()) {
      next_ = std::move(urgent_.front());
      urgent_.pop_front();
      return true;
    }
  }
  while (current_ || take_view()) {
    if (publisher_.next(next_.channel, next_.bytes)) return true;
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
  if (current_) publisher_.begin(*current_, clock_.now_ns());
  return current_ != nullptr;
}

void Outbox::send_next() {
  const bool sent = send_(next_.channel, next_.bytes);
  ++burst_messages_;
  burst_bytes_ += next_.bytes.size();
  const std::lock_guard lock(mutex_);
  if (sent) {
    ++counters_.datagrams;
    counters_.bytes += next_.bytes.size();
  } else {
    ++counters_.errors;
  }
  next_.channel.clear();
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
    } else {
      lock.unlock();
      clock_.sleep_until(due);
    }
  }
}

OutboxCounters Outbox::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace tumble
