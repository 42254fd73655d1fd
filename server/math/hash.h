// 64-bit hash of a stream of words: the fingerprint of a world's state. Two runs are equal iff every bit of every
// hashed number is; collisions are a matter of 2^-64. FNV-1a's step on whole words, finished by a mix of its own.
#pragma once

#include <bit>
#include <cstdint>

#include "math/types.h"

namespace tumble {

class Hash {
 public:
  void add(std::uint64_t word) {
    value_ = (value_ ^ word) * 0x100000001b3ull;
    value_ ^= value_ >> 29;
  }
  void add(double x) { add(std::bit_cast<std::uint64_t>(x)); }
  void add(const Vec3& v) {
    add(v.x());
    add(v.y());
    add(v.z());
  }
  void add(const Quat& q) {
    add(q.w());
    add(q.x());
    add(q.y());
    add(q.z());
  }
  std::uint64_t value() const { return value_ ^ (value_ >> 32); }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ull;  // FNV offset basis
};

}  // namespace tumble
