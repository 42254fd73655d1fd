// See ordered_log.h.
#include "net/ordered_log.h"

#include <chrono>
#include <system_error>
#include <utility>

namespace tumble {
namespace {

/// Of events behind a record that the disk is slow to take; with more than that the world waits.
constexpr std::size_t kMostWaiting = 64 << 20;

}  // namespace

OrderedLog::~OrderedLog() {
  if (!lent_.valid()) return;
  try {
    finish();
  } catch (const std::system_error&) {  // whoever wants to know calls finish()
  }
}

void OrderedLog::write(std::int64_t utime, std::string_view channel, Bytes data) {
  if (take_back(waiting_bytes_ > kMostWaiting)) return writer_.value().write(utime, channel, data);
  waiting_.push_back({.utime = utime, .channel = std::string(channel), .data = {data.begin(), data.end()}});
  waiting_bytes_ += data.size();
}

void OrderedLog::write_beside(std::function<void(EventLogWriter&)> write_record) {
  take_back(true);
  lent_ = std::async(
      std::launch::async,
      [](EventLogWriter writer, const std::function<void(EventLogWriter&)>& write_it) {
        write_it(writer);
        writer.flush();
        return writer;
      },
      std::move(writer_.value()), std::move(write_record));
  writer_.reset();
}

bool OrderedLog::flush() {
  if (!take_back(false)) return false;
  writer_.value().flush();
  return true;
}

void OrderedLog::finish() {
  take_back(true);
  writer_.value().flush();
}

/// True: it is here, and what waited is written.
bool OrderedLog::take_back(bool wait) {
  if (!lent_.valid()) return true;
  if (!wait && lent_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
  writer_ = lent_.get();
  waiting_bytes_ = 0;
  for (const LogEvent& event : std::exchange(waiting_, {})) {
    writer_->write(event.utime, event.channel, event.data);
  }
  return true;
}

}  // namespace tumble
