// The layout of LCM messages on the wire (big endian, fields in order of declaration), walked before the generated
// decoders see the bytes: they would throw on a negative count and allocate whatever a count asks for. Used by codec*.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "protocol/codec.h"

namespace tumble {

inline constexpr std::size_t kFingerprint = 8;

inline std::uint64_t read_u64(Bytes bytes, std::size_t at) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8; ++i) value = value << 8 | bytes[at + i];
  return value;
}

inline std::uint32_t read_u32(Bytes bytes, std::size_t at) {
  return static_cast<std::uint32_t>(bytes[at]) << 24 | static_cast<std::uint32_t>(bytes[at + 1]) << 16 |
         static_cast<std::uint32_t>(bytes[at + 2]) << 8 | bytes[at + 3];
}

/// Walks fixed bytes and strings in wire order; the first failure stays.
class Walker {
 public:
  explicit Walker(Bytes bytes) : bytes_(bytes) {}

  Walker& fixed(std::size_t size) {
    if (reason_ != Malformed::none) return *this;
    if (bytes_.size() - at_ < size) return fail(Malformed::too_short);
    at_ += size;
    return *this;
  }
  /// A string on the wire: length with the closing zero, bytes, zero.
  Walker& text(std::size_t limit) {
    const std::size_t length_at = at_;
    if (fixed(4).reason_ != Malformed::none) return *this;
    const std::uint32_t length = read_u32(bytes_, length_at);
    if (length == 0 || length > limit + 1) return fail(Malformed::bad_text);
    if (fixed(length).reason_ != Malformed::none) return *this;
    const Bytes content = bytes_.subspan(at_ - length, length);
    if (std::memchr(content.data(), 0, length) != &content.back()) return fail(Malformed::bad_text);
    return *this;
  }
  /// An int32 that says how many rows of arrays follow; kept in `value`. Each row takes a byte at least.
  Walker& count(std::size_t& value) {
    value = 0;
    const std::size_t count_at = at_;
    if (fixed(4).reason_ != Malformed::none) return *this;
    const std::uint32_t rows = read_u32(bytes_, count_at);
    if (rows > bytes_.size() - at_) return fail(Malformed::too_short);  // negative ones too
    value = rows;
    return *this;
  }
  Walker& texts(std::size_t number, std::size_t limit) {
    for (std::size_t i = 0; i < number && reason_ == Malformed::none; ++i) text(limit);
    return *this;
  }
  Malformed end() const {
    if (reason_ == Malformed::none && at_ != bytes_.size()) return Malformed::too_long;
    return reason_;
  }

 private:
  Walker& fail(Malformed reason) {
    reason_ = reason;
    return *this;
  }
  Bytes bytes_;
  std::size_t at_ = 0;
  Malformed reason_ = Malformed::none;
};

/// The type's fingerprint stands at the start, and no more than `most` bytes follow in all.
template <typename Message>
Malformed check_start(Bytes bytes, std::size_t most) {
  if (bytes.size() < kFingerprint) return Malformed::too_short;
  if (read_u64(bytes, 0) != static_cast<std::uint64_t>(Message::getHash()))
    return Malformed::wrong_fingerprint;
  return bytes.size() > most ? Malformed::too_long : Malformed::none;
}

template <typename Message>
Malformed decode_checked(Bytes bytes, Message& message) {
  const int size = static_cast<int>(bytes.size());
  return message.decode(bytes.data(), 0, size) == size ? Malformed::none : Malformed::too_short;
}

}  // namespace tumble
