// What the last clipping of a pair's faces found: which corners were inside of which sides, and which edges crossed them.
// While the same comparisons come out the same, these crossings are all there is to compute: the points are those of a
// clipping afresh, to the bit.
#pragma once

#include <array>
#include <cstdint>

namespace tumble {

/// Places are numbered: first the corners of the incident face, in loop order, then the crossings, in the order they are
/// made.
struct ClipTape {
  static constexpr std::size_t kSides = 8, kPlaces = 16, kLoop = 10, kCut = 2;

  /// An edge of the polygon, between two places, that a side crosses.
  struct Crossing {
    std::uint8_t from, to;
  };
  /// One side of the reference face and the polygon that it met.
  struct Side {
    std::uint8_t count = 0;  ///< Of the polygon's corners; 0: nothing of it could be outside.
    std::uint8_t crossings = 0;
    std::uint16_t inside = 0;  ///< A bit for each corner.
    std::array<Crossing, kCut> crossing;
    std::array<std::uint8_t, kLoop> loop;
  };

  /// The faces that met; 0: nothing is kept.
  std::uint32_t faces = 0;
  std::uint8_t count = 0;  ///< Of corners that are left.
  std::array<std::uint8_t, kLoop> left;
  std::array<std::uint32_t, kLoop> names;
  std::array<Side, kSides> sides;
};

/// What a pair keeps of its last clipping.
struct KeptClip {
  bool wanted = false;  ///< Set before a query: a tape is worth its writing.
  bool held = false;    ///< Set by it: the points came from the tape.
  ClipTape tape;
};

}  // namespace tumble
