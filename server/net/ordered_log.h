// A log that goes on while a long record is made beside it: another thread makes and writes that one, what comes after
// it waits in memory and follows in its order. The file is one thread's at a time, handed over and back, never shared.
#pragma once

#include <functional>
#include <future>
#include <optional>
#include <string_view>
#include <vector>

#include "net/event_log.h"

namespace tumble {

/// Everything throws std::system_error if the file can't take it; nothing can be written after that.
class OrderedLog {
 public:
  explicit OrderedLog(EventLogWriter writer) : writer_(std::move(writer)) {}
  OrderedLog(OrderedLog&&) = default;
  OrderedLog& operator=(OrderedLog&&) = delete;
  ~OrderedLog();  ///< As finish().

  void write(std::int64_t utime, std::string_view channel, Bytes data);
  /// `write_record` runs in another thread and writes what stands here in the order of records. Waits for the last one.
  void write_beside(std::function<void(EventLogWriter&)> write_record);
  /// True: what was written outlives this process, however it ends. False: a record is being made; ask again.
  bool flush();
  /// Waits until that is so.
  void finish();

 private:
  bool take_back(bool wait);

  std::optional<EventLogWriter> writer_;  // none while the other thread has it
  std::future<EventLogWriter> lent_;
  std::vector<LogEvent> waiting_;  // only while it is lent
  std::size_t waiting_bytes_ = 0;
};

}  // namespace tumble
