// The default build needs a CPU of the x86-64-v3 level. An older one would die of an illegal instruction; this runs
// before anything else in the program, is itself compiled for any x86-64 (server/CMakeLists.txt), and says so instead.
#include <unistd.h>

#include <string_view>

namespace {

__attribute__((constructor(101))) void check_cpu() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2"))
    return;
  constexpr std::string_view text =
      "tumble-server: this CPU lacks AVX2, FMA or BMI2, for which the program was built (x86-64-v3).\n"
      "Build it for this one: cmake -B build -DTUMBLE_ARCH=x86-64 && cmake --build build\n";
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
  ::_exit(1);
}

}  // namespace
