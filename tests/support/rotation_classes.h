// Random free rotations by class of difficulty: unit-mass boxes and what degenerates from them. A case follows from its
// class and number.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include "math/types.h"

namespace tumble::test {

enum class RotationClass {
  boxes,            ///< Edges 0.1..1.1 m, |w_i| <= 5 rad/s.
  one_tiny,         ///< One component of w times 1e-1..1e-15.
  near_spin,        ///< Two components tiny.
  dzhanibekov,      ///< About the middle axis + 1e-1..1e-15.
  near_symmetric,   ///< Two moments apart by 1e-2..1e-15 of themselves.
  near_spherical,   ///< All three.
  rods_and_plates,  ///< Edges 1..1e-3, so moments to 1:1e6.
  separatrix,       ///< On the separatrix to rounding: how it goes on is in the last bit of the data.
};

inline constexpr std::array<const char*, 8> kRotationClassNames = {
    "boxes",          "one_tiny",       "near_spin",       "dzhanibekov",
    "near_symmetric", "near_spherical", "rods_and_plates", "separatrix"};

struct RandomRotation {
  Vec3 I, w;  ///< Body axes are principal.
  double t;   ///< [s], 0..10
};

inline RandomRotation random_rotation(RotationClass kind, std::uint64_t number) {
  std::mt19937_64 random(1000003 * static_cast<std::uint64_t>(kind) + number);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
  };
  const auto tiny = [&] { return std::pow(10.0, uniform(-15.0, -1.0)); };
  const auto of_box = [](const Vec3& edge) {
    const Vec3 s = edge.cwiseProduct(edge);
    return Vec3(Vec3(s.y() + s.z(), s.z() + s.x(), s.x() + s.y()) / 12.0);
  };
  RandomRotation c;
  Vec3 edge;
  for (int i = 0; i < 3; ++i) edge[i] = uniform(0.1, 1.1);
  for (int i = 0; i < 3; ++i) c.w[i] = uniform(-5.0, 5.0);
  c.I = of_box(edge);
  c.t = uniform(0.0, 10.0);
  std::array<int, 3> axes = {0, 1, 2};
  std::sort(axes.begin(), axes.end(), [&](int i, int j) { return c.I[i] < c.I[j]; });
  const auto [low, middle, high] = axes;
  const int any = static_cast<int>(random() % 3);
  switch (kind) {
    case RotationClass::boxes:
      break;
    case RotationClass::one_tiny:
      c.w[any] *= tiny();
      break;
    case RotationClass::near_spin:
      c.w[(any + 1) % 3] *= tiny();
      c.w[(any + 2) % 3] *= tiny();
      break;
    case RotationClass::dzhanibekov:
      c.w[low] *= tiny();
      c.w[high] *= tiny();
      break;
    case RotationClass::near_symmetric:
      c.I[(any + 1) % 3] = c.I[any] * (1.0 + 10.0 * uniform(-1.0, 1.0) * 0.1 * tiny());
      c.I[(any + 2) % 3] = std::min(c.I[(any + 2) % 3], 1.9 * c.I[any]);
      break;
    case RotationClass::near_spherical:
      for (int i = 1; i < 3; ++i) c.I[i] = c.I[0] * (1.0 + 0.1 * tiny());
      break;
    case RotationClass::rods_and_plates:
      for (int i = 0; i < 3; ++i) edge[i] = std::pow(10.0, uniform(-3.0, 0.0));
      c.I = of_box(edge);
      break;
    case RotationClass::separatrix:
      // I_3 d_23 w_3^2 = I_1 d_12 w_1^2
      c.w[high] =
          c.w[low] * std::sqrt(c.I[low] * (c.I[middle] - c.I[low]) / (c.I[high] * (c.I[high] - c.I[middle])));
      break;
  }
  return c;
}

}  // namespace tumble::test
