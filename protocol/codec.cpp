// See codec.h. Strings are the only parts of the received types that vary in length; they are walked here before the
// generated decoder sees the bytes, so that it can neither throw nor over-allocate.
#include "protocol/codec.h"

#include <bit>
#include <cmath>
#include <initializer_list>
#include <span>

#include "protocol/layout.h"

namespace tumble {
namespace {

/// Start of both command types: utime, session, client, sequence.
constexpr std::size_t kClientOffset = kFingerprint + 16, kSequenceOffset = kFingerprint + 24;
constexpr std::size_t kSenderBytes = kFingerprint + 32;

struct Field {
  const char* name;
  std::span<const double> values;
};

const char* first_not_finite(std::initializer_list<Field> fields) {
  for (const Field& field : fields) {
    for (const double value : field.values) {
      if (!std::isfinite(value)) return field.name;
    }
  }
  return nullptr;
}

}  // namespace

const char* malformed_text(Malformed reason) {
  switch (reason) {
    case Malformed::none:
      return "sound";
    case Malformed::too_short:
      return "it ends too early";
    case Malformed::too_long:
      return "it is too long";
    case Malformed::wrong_fingerprint:
      return "it is of another type or version";
    case Malformed::bad_text:
      return "a text in it is damaged or too long";
    case Malformed::count:
      break;
  }
  return "unknown reason";
}

Malformed decode(Bytes bytes, force_command_t& message) {
  if (const Malformed reason = check_start<force_command_t>(bytes, kMaxCommandBytes);
      reason != Malformed::none)
    return reason;
  const auto size = static_cast<std::size_t>(message.getEncodedSize());
  if (bytes.size() < size) return Malformed::too_short;
  if (bytes.size() > size) return Malformed::too_long;
  return decode_checked(bytes, message);
}

Malformed decode(Bytes bytes, control_t& message) {
  if (const Malformed reason = check_start<control_t>(bytes, kMaxCommandBytes); reason != Malformed::none)
    return reason;
  constexpr std::size_t before_name = kFingerprint + 6 * 8 + 1 + 8 + 2 * 4;
  constexpr std::size_t after_name = 2 + 3 * 8 + 8 + 3 * 8 + 4 * 8 + 3 * 8 + 3 * 8 + 2 * 8 + 4 * 4;
  const Malformed reason = Walker(bytes).fixed(before_name).text(kMaxBodyName).fixed(after_name).end();
  return reason == Malformed::none ? decode_checked(bytes, message) : reason;
}

Malformed decode(Bytes bytes, query_t& message) {
  if (const Malformed reason = check_start<query_t>(bytes, kMaxCommandBytes); reason != Malformed::none) {
    return reason;
  }
  const Malformed reason = Walker(bytes).fixed(static_cast<std::size_t>(message.getEncodedSize())).end();
  return reason == Malformed::none ? decode_checked(bytes, message) : reason;
}

Malformed decode(Bytes bytes, heartbeat_t& message) {
  if (const Malformed reason = check_start<heartbeat_t>(bytes, kMaxCommandBytes); reason != Malformed::none)
    return reason;
  constexpr std::size_t kText = 255;
  const Malformed reason = Walker(bytes)
                               .fixed(kFingerprint + 2 * 8 + 2 * 4)
                               .text(kText)
                               .text(kText)
                               .text(kText)
                               .text(kText)
                               .fixed(5 * 8 + 1 + 2 * 8 + 2 * 4)
                               .end();
  return reason == Malformed::none ? decode_checked(bytes, message) : reason;
}

Sender read_sender(Bytes bytes) {
  if (bytes.size() < kSenderBytes) return {};
  const std::uint64_t fingerprint = read_u64(bytes, 0);
  if (fingerprint != static_cast<std::uint64_t>(force_command_t::getHash()) &&
      fingerprint != static_cast<std::uint64_t>(control_t::getHash())) {
    return {};
  }
  return {std::bit_cast<std::int64_t>(read_u64(bytes, kClientOffset)),
          std::bit_cast<std::int64_t>(read_u64(bytes, kSequenceOffset))};
}

const char* find_not_finite(const force_command_t& c) {
  return first_not_finite(
      {{"force", c.force}, {"torque", c.torque}, {"point", c.point}, {"duration", {&c.duration, 1}}});
}

const char* find_not_finite(const query_t& query) {
  return first_not_finite({{"origin", query.origin},
                           {"direction", query.direction},
                           {"size", query.size},
                           {"orientation", query.orientation},
                           {"length", {&query.length, 1}}});
}

const char* find_not_finite(const control_t& c) {
  for (const float value : c.color) {
    if (!std::isfinite(value)) return "color";
  }
  return first_not_finite({{"size", c.size},
                           {"position", c.position},
                           {"orientation", c.orientation},
                           {"velocity", c.velocity},
                           {"angular_velocity", c.angular_velocity},
                           {"mass", {&c.mass, 1}},
                           {"friction", {&c.friction, 1}},
                           {"restitution", {&c.restitution, 1}}});
}

}  // namespace tumble
