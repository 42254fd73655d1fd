// The fingerprint sees every bit, the order, and the sign of zero; and it is the same everywhere for ever.
#include "math/hash.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace tumble {
namespace {

template <typename... Words>
std::uint64_t hash_of(Words... words) {
  Hash hash;
  (hash.add(words), ...);
  return hash.value();
}

TEST(Hash, IsFixedForEver) {
  EXPECT_EQ(hash_of(std::uint64_t{1}, 2.5, Vec3(1, 2, 3), Quat::Identity()), 0x598d823a2abdf561ull);
}

TEST(Hash, SeesEveryBitOfADouble) {
  std::set<std::uint64_t> seen = {hash_of(1.0)};
  for (int bit = 0; bit < 64; ++bit) {
    const double x = std::bit_cast<double>(std::bit_cast<std::uint64_t>(1.0) ^ (std::uint64_t{1} << bit));
    EXPECT_TRUE(seen.insert(hash_of(x)).second) << bit;
  }
  EXPECT_NE(hash_of(0.0), hash_of(-0.0));
  EXPECT_NE(hash_of(1.0), hash_of(std::nextafter(1.0, 2.0)));
}

TEST(Hash, SeesTheOrderAndTheCount) {
  EXPECT_NE(hash_of(1.0, 2.0), hash_of(2.0, 1.0));
  EXPECT_NE(hash_of(0.0), hash_of(0.0, 0.0));
  EXPECT_NE(Hash().value(), hash_of(0.0));
}

TEST(Hash, OfAVectorIsThatOfItsComponents) {
  EXPECT_EQ(hash_of(Vec3(1, 2, 3)), hash_of(1.0, 2.0, 3.0));
  EXPECT_EQ(hash_of(Quat(1, 2, 3, 4)), hash_of(1.0, 2.0, 3.0, 4.0));  // scalar first
}

TEST(Hash, ManyNeighbouringStatesDoNotCollide) {
  std::set<std::uint64_t> seen;
  double x = 1.0;
  for (int i = 0; i < 100000; ++i) {
    EXPECT_TRUE(seen.insert(hash_of(x, 1.0 - x)).second);
    x = std::nextafter(x, 2.0);
  }
}

}  // namespace
}  // namespace tumble
