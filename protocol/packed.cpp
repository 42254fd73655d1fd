// See packed.h.
#include "protocol/packed.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#include "protocol/columns.h"

namespace tumble {
namespace {

constexpr int kIdBits = 14, kFlagBits = 3, kGenerationBits = 4, kPositionBits = 20, kTurnBits = 13,
              kSpeedBits = 13;
constexpr std::array<std::int8_t, kFlagBits> kKeptFlags = {state_t::FLAG_RESTING, state_t::FLAG_CONTAINED,
                                                           state_t::FLAG_WATCHED};
constexpr double kTurnLimit = 0.70710678118654752;  // of a component that is not the largest
constexpr double kMaxTurn = (1 << kTurnBits) - 1, kMaxPosition20 = (1 << kPositionBits) - 1;
constexpr int kFractionBits = 7, kExponentOffset = 15, kMaxExponent = 31;

class BitWriter {
 public:
  explicit BitWriter(PackedRecord record) : record_(record) { std::fill(record.begin(), record.end(), 0); }
  void put(std::uint32_t value, int bits) {
    for (int bit = bits - 1; bit >= 0; --bit, ++at_) {
      if (value >> bit & 1u)
        record_[at_ / 8] = static_cast<std::uint8_t>(record_[at_ / 8] | 0x80u >> at_ % 8);
    }
  }

 private:
  PackedRecord record_;
  std::size_t at_ = 0;
};

class BitReader {
 public:
  explicit BitReader(std::span<const std::uint8_t, kPackedRecord> record) : record_(record) {}
  std::uint32_t get(int bits) {
    std::uint32_t value = 0;
    for (int bit = 0; bit < bits; ++bit, ++at_) value = value << 1 | (record_[at_ / 8] >> (7 - at_ % 8) & 1u);
    return value;
  }

 private:
  std::span<const std::uint8_t, kPackedRecord> record_;
  std::size_t at_ = 0;
};

/// Sign, exponent and fraction of `x`, rounded to the nearest.
std::uint32_t to_short_float(double x) {
  const std::uint32_t sign = std::signbit(x) ? 1u << (kSpeedBits - 1) : 0u;
  const double size = std::abs(x);
  if (size == 0.0) return sign;
  int exponent = 0;
  std::frexp(size, &exponent);  // size = f * 2^exponent, f in [0.5, 1)
  const int stored = std::max(exponent - 1 + kExponentOffset, 0);
  // In units of the last place; carries of the rounding run into the exponent as they should.
  const int scale = std::max(stored, 1) - kExponentOffset - kFractionBits;
  const auto units = static_cast<std::uint32_t>(std::nearbyint(std::ldexp(size, -scale)));
  const std::uint32_t whole = 1u << kFractionBits;
  const std::uint32_t code =
      stored == 0 ? units : (static_cast<std::uint32_t>(stored) << kFractionBits) + units - whole;
  return sign | std::min(code, (1u << (kSpeedBits - 1)) - 1);
}

double from_short_float(std::uint32_t code) {
  const std::uint32_t size = code & ((1u << (kSpeedBits - 1)) - 1);
  const int exponent = static_cast<int>(size >> kFractionBits);
  const auto fraction = static_cast<double>(size & ((1u << kFractionBits) - 1));
  const double units = exponent == 0 ? fraction : fraction + (1 << kFractionBits);
  const double value = std::ldexp(units, std::max(exponent, 1) - kExponentOffset - kFractionBits);
  return code >> (kSpeedBits - 1) ? -value : value;
}

void put_orientation(const double* q, BitWriter& out) {
  const double* largest =
      std::max_element(q, q + 4, [](double a, double b) { return std::abs(a) < std::abs(b); });
  const auto index = static_cast<std::uint32_t>(largest - q);
  out.put(index, 2);
  const double sign = *largest < 0.0 ? -1.0 : 1.0;
  for (std::uint32_t i = 0; i < 4; ++i) {
    if (i == index) continue;
    const double part = std::clamp((sign * q[i] + kTurnLimit) / (2.0 * kTurnLimit), 0.0, 1.0);
    out.put(static_cast<std::uint32_t>(std::lround(part * kMaxTurn)), kTurnBits);
  }
}

void get_orientation(BitReader& in, double* q) {
  const std::uint32_t index = in.get(2);
  double rest = 1.0;
  for (std::uint32_t i = 0; i < 4; ++i) {
    if (i == index) continue;
    q[i] = in.get(kTurnBits) / kMaxTurn * 2.0 * kTurnLimit - kTurnLimit;
    rest -= q[i] * q[i];
  }
  q[index] = std::sqrt(std::max(rest, 0.0));
}

}  // namespace

void pack_body(const PackedBody& body, const packed_t& message, PackedRecord record) {
  BitWriter out(record);
  out.put(body.id - static_cast<std::uint32_t>(message.first_id), kIdBits);
  for (const std::int8_t flag : kKeptFlags) out.put((body.flags & flag) != 0 ? 1u : 0u, 1);
  out.put(body.generation % kPackedGenerations, kGenerationBits);
  for (std::size_t i = 0; i < 3; ++i) {
    const double part = std::clamp((body.values[i] - message.origin[i]) / message.edge, 0.0, 1.0);
    out.put(static_cast<std::uint32_t>(std::lround(part * kMaxPosition20)), kPositionBits);
  }
  put_orientation(body.values.data() + 3, out);
  for (std::size_t i = 7; i < 13; ++i) out.put(to_short_float(body.values[i]), kSpeedBits);
}

PackedBody unpack_body(std::span<const std::uint8_t, kPackedRecord> record, const packed_t& message) {
  BitReader in(record);
  PackedBody body;
  body.id = static_cast<std::uint32_t>(message.first_id) + in.get(kIdBits);
  for (const std::int8_t flag : kKeptFlags)
    body.flags = static_cast<std::int8_t>(body.flags | (in.get(1) != 0 ? flag : 0));
  body.generation = in.get(kGenerationBits);
  for (std::size_t i = 0; i < 3; ++i) {
    body.values[i] = message.origin[i] + in.get(kPositionBits) / kMaxPosition20 * message.edge;
  }
  get_orientation(in, body.values.data() + 3);
  for (std::size_t i = 7; i < 13; ++i) body.values[i] = from_short_float(in.get(kSpeedBits));
  return body;
}

void unpack(const packed_t& message, state_t& state) {
  state = {};
  state.utime = message.utime;
  state.session = message.session;
  state.step = message.step;
  state.time = message.time;
  state.state_hash = message.state_hash;
  state.catalog_epoch = message.catalog_epoch;
  state.num_bodies = message.num_bodies;
  state.chunk = message.chunk;
  state.num_chunks = message.num_chunks;
  state.n = message.n;
  const auto columns = motion_columns(state);
  for (std::int32_t row = 0; row < message.n; ++row) {
    const auto at = message.records.data() + static_cast<std::size_t>(row) * kPackedRecord;
    const PackedBody body =
        unpack_body(std::span<const std::uint8_t, kPackedRecord>(at, kPackedRecord), message);
    state.id.push_back(static_cast<std::int32_t>(body.id));
    state.generation.push_back(static_cast<std::int32_t>(body.generation));
    state.flags.push_back(body.flags);
    for (std::size_t k = 0; k < body.values.size(); ++k) columns[k]->push_back(body.values[k]);
  }
}

}  // namespace tumble
