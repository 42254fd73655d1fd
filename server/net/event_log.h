// LCM's log format, written and read: a file of events, each a header of 28 bytes (sync word, number, time, lengths),
// its channel and its message. lcm-logplayer, lcm-logger's readers and every LCM language's EventLog read the same.
// liblcm's own writer restarts its numbers when it appends, and its reader doesn't say where a file is damaged.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/codec.h"

namespace tumble {

struct LogEvent {
  std::int64_t number = 0;  ///< Counts from 0.
  std::int64_t utime = 0;   ///< [us since 1970]
  std::string channel;
  std::vector<std::uint8_t> data;
};

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, FileCloser>;

class EventLogWriter {
 public:
  /// A new file; throws std::system_error if there is one already or it can't be made.
  explicit EventLogWriter(const std::string& path);
  /// Goes on in a file after `size` bytes, what follows them is cut off; `number` is the next event's.
  EventLogWriter(const std::string& path, std::int64_t size, std::int64_t number);

  /// Throws std::system_error if the file can't take it.
  void write(std::int64_t utime, std::string_view channel, Bytes data);
  /// Hands everything to the system: from then on it outlives this process, however it ends.
  void flush();

 private:
  File file_;
  std::int64_t number_ = 0;
};

struct LogDamage {
  std::int64_t offset = 0;  ///< Of the first byte that is not sound; the file is good up to here.
  bool cut = false;         ///< The file just ends there, in the middle of an event: its writer was killed.
  std::string what;         ///< One sentence, for people.
};

class EventLogReader {
 public:
  explicit EventLogReader(const std::string& path);  ///< Throws std::system_error.

  /// The next event; none at the end of the file, or at damage().
  std::optional<LogEvent> next();
  const std::optional<LogDamage>& damage() const { return damage_; }
  /// Goes on at an event that starts at `offset`, the `count`-th of the file: as another reader found it.
  void skip_to(std::int64_t offset, std::int64_t count);
  std::int64_t offset() const { return offset_; }  ///< End of the last event that was read.
  std::int64_t count() const { return count_; }    ///< Events read.

 private:
  std::optional<LogEvent> stop(std::string what);
  bool sync_follows();

  File file_;
  std::int64_t size_ = 0, offset_ = 0, count_ = 0;
  std::optional<LogDamage> damage_;
};

}  // namespace tumble
