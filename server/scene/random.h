// Random numbers for the arrangement of populations: the same sequence on every machine, seeded by the scene.
// splitmix64 (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators").
#pragma once

#include <cmath>
#include <cstdint>

#include "math/rotation.h"

namespace tumble {

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t word() {
    state_ += 0x9e3779b97f4a7c15ull;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  /// Uniform in [-1, 1), a multiple of 2^-52.
  double symmetric() { return static_cast<double>(static_cast<std::int64_t>(word()) >> 11) * 0x1p-52; }
  /// Uniform in the box of half sizes h around the origin.
  Vec3 in_box(const Vec3& h) {
    const double x = symmetric(), y = symmetric(),
                 z = symmetric();  // one declarator after the other: fixed order
    return Vec3(x * h.x(), y * h.y(), z * h.z());
  }
  /// Uniform over all rotations: a point of the unit 3-sphere, found by rejection from its cube.
  Quat rotation() {
    for (;;) {
      const double w = symmetric(), x = symmetric(), y = symmetric(), z = symmetric();
      const double norm2 = w * w + x * x + y * y + z * z;
      if (norm2 > 0.01 && norm2 <= 1.0) return normalized(Quat(w, x, y, z));
    }
  }

 private:
  std::uint64_t state_;
};

}  // namespace tumble
