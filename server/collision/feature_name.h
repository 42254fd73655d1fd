// Names of contact points: what of A meets what of B, as one number. A name lives as long as its features touch, whichever
// axis separates best and whichever face was cut, so a solver's impulses stay with their points.
#pragma once

#include <algorithm>
#include <cstdint>

namespace tumble {

/// Mixes numbers of features into one that stays the same as long as all of them do.
constexpr std::uint32_t mix_features(std::uint32_t a, std::uint32_t b, std::uint32_t c = 0) {
  std::uint64_t h = (a * 0x9e3779b97f4a7c15ull) ^ (b * 0xc2b2ae3d27d4eb4full + 0x165667b19e3779f9ull) ^
                    (c * 0xff51afd7ed558ccdull);
  h = (h ^ (h >> 32)) * 0xd6e8feb86659fd93ull;
  return static_cast<std::uint32_t>(h ^ (h >> 32));
}

/// A vertex on the other body's face.
constexpr std::uint32_t name_vertex(bool of_a, std::uint32_t vertex) {
  return mix_features(vertex, 0, of_a ? 1 : 2);
}

/// An edge of A across an edge of B, each given by its two vertices in either order.
constexpr std::uint32_t name_crossing(std::uint32_t a1, std::uint32_t a2, std::uint32_t b1,
                                      std::uint32_t b2) {
  const auto edge = [](std::uint32_t v, std::uint32_t w) { return std::max(v, w) << 16 ^ std::min(v, w); };
  return mix_features(edge(a1, a2), edge(b1, b2), 3);
}

/// Corners or edges that look at each other across a gap, whichever they are.
constexpr std::uint32_t name_corners() {
  return mix_features(0, 0, 4);
}

}  // namespace tumble
