// The version of the program, as the build names it.
#pragma once

namespace tumble {

inline constexpr const char* kVersion = TUMBLE_VERSION;

}  // namespace tumble
