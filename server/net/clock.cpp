// See clock.h.
#include "net/clock.h"

#include <ctime>

namespace tumble {
namespace {

constexpr std::int64_t kNanoseconds = 1'000'000'000;

std::int64_t read_ns(clockid_t clock) {
  timespec time{};
  ::clock_gettime(clock, &time);
  return time.tv_sec * kNanoseconds + time.tv_nsec;
}

}  // namespace

std::int64_t SystemClock::wall_us() {
  return read_ns(CLOCK_REALTIME) / 1000;
}

std::int64_t SystemClock::now_ns() {
  return read_ns(CLOCK_MONOTONIC);
}

void SystemClock::sleep_until(std::int64_t ns) {
  const timespec until{ns / kNanoseconds, ns % kNanoseconds};
  ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);  // a signal ends it early
}

}  // namespace tumble
