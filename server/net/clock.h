// The only source of time of the server and its I/O, so that tests can hold it in their hand.
#pragma once

#include <cstdint>

namespace tumble {

class Clock {
 public:
  virtual ~Clock() = default;
  virtual std::int64_t wall_us() = 0;  ///< Microseconds since 1970: the `utime` of the messages.
  virtual std::int64_t now_ns() = 0;   ///< Never goes back; nanoseconds since some start.
  virtual void sleep_until(
      std::int64_t ns) = 0;  ///< Returns at once if `ns` of now_ns has passed; may return early.
};

/// The system's clocks.
class SystemClock final : public Clock {
 public:
  std::int64_t wall_us() override;
  std::int64_t now_ns() override;
  void sleep_until(std::int64_t ns) override;
};

}  // namespace tumble
