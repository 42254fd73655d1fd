// The record of a body in packed_t: 200 bits, most significant first. Positions are whole numbers of a cube around the
// bodies of the message, orientations the three smaller components of the quaternion, velocities short floats.
//
//   14  id - first_id          3  flags: resting, contained, watched          4  generation's lowest bits
//   3 x 20  position: round((p - origin) / edge * (2^20 - 1))
//   2 + 3 x 13  orientation: index of the largest component (made positive), the others round((q + s) / 2s * 8191),
//               s = 1/sqrt(2)
//   3 x 13  velocity, 3 x 13  angular velocity: sign, 5 bits of exponent (offset 15), 7 of fraction, as IEEE 754 would
//
// Bounds of the errors: position edge / 2^21 a component; orientation 6e-4 rad (2 sqrt 12 / (8191 sqrt 2)); velocities 2^-8 of each component, below
// 2^-14 (m/s, rad/s) 2^-22; beyond 131 000 they are cut to that.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "protocol/channels.h"
#include "tumble/packed_t.hpp"
#include "tumble/state_t.hpp"

namespace tumble {

struct PackedBody {
  std::uint32_t id = 0, generation = 0;  ///< generation: its lowest kPackedGenerations are kept.
  std::int8_t flags = 0;                 ///< state_t::FLAG_*; those of the body's type are not kept.
  std::array<double, 13> values{};       ///< p, q (w, x, y, z), v, w: as in state_t.
};

/// Bodies of a message have ids from first_id up to less than first_id + this.
inline constexpr std::uint32_t kPackedIds = 1u << 14;
inline constexpr std::uint32_t kPackedGenerations = 1u << 4;
/// The cube is at least so large: positions are then good to 31 um [m].
inline constexpr double kPackedEdge = 64.0;

using PackedRecord = std::span<std::uint8_t, kPackedRecord>;

/// `message` says origin, edge and first_id; the body's id and position must fit them.
void pack_body(const PackedBody& body, const packed_t& message, PackedRecord record);
PackedBody unpack_body(std::span<const std::uint8_t, kPackedRecord> record, const packed_t& message);

/// The same content as state_t; generations are in 0 .. kPackedGenerations - 1, see Picture. `message` was decoded by
/// codec.h.
void unpack(const packed_t& message, state_t& state);

}  // namespace tumble
