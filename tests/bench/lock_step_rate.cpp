// How fast a client that holds the clock can be: round trips of STEP 1 and the whole state after it.
// Prints round trips a second and the microseconds of the median and the 99th of a hundred.
//   lock_step_rate [COUNT [WORLD]]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "tumble/world.h"

int main(int argc, char** argv) {
  using Clock = std::chrono::steady_clock;
  const int count = argc > 1 ? std::atoi(argv[1]) : 2000;
  tumble::client::WorldOptions options;
  options.timing.limit = std::chrono::seconds(10);
  tumble::client::World world(options);
  world.wait_for_picture(10.0);
  world.pause();
  std::vector<double> micros;
  const auto start = Clock::now();
  for (int i = 0; i < count; ++i) {
    const auto before = Clock::now();
    world.advance();
    micros.push_back(std::chrono::duration<double, std::micro>(Clock::now() - before).count());
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  std::sort(micros.begin(), micros.end());
  std::printf("%.0f %.0f %.0f\n", count / seconds, micros[micros.size() / 2],
              micros[micros.size() * 99 / 100]);
  world.resume();
}
