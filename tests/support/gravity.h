// The gravity of the scenes that tests build, which is the default of Options.
#pragma once

namespace tumble {

inline constexpr double kG = 9.81;  // [m/s^2]

}  // namespace tumble
