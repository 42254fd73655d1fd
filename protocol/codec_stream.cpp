// Checked decoding of what the server streams, see codec.h: arrays whose lengths are fields of the message.
#include "protocol/layout.h"

namespace tumble {
namespace {

constexpr std::size_t kMaxStreamBytes = 1 << 16;  // a UDP datagram holds less

}  // namespace

Malformed decode(Bytes bytes, state_t& message) {
  if (const Malformed reason = check_start<state_t>(bytes, kMaxStreamBytes); reason != Malformed::none)
    return reason;
  std::size_t n = 0;
  Walker walker(bytes);
  walker.fixed(kFingerprint + 6 * 8 + 4 + 2 * 2).count(n).fixed(n * (2 * 4 + 1 + 13 * 8));
  return walker.end() == Malformed::none ? decode_checked(bytes, message) : walker.end();
}

Malformed decode(Bytes bytes, stats_t& message) {
  if (const Malformed reason = check_start<stats_t>(bytes, kMaxStreamBytes); reason != Malformed::none)
    return reason;
  const auto size = static_cast<std::size_t>(message.getEncodedSize());
  const Malformed reason = Walker(bytes).fixed(size).end();
  return reason == Malformed::none ? decode_checked(bytes, message) : reason;
}

Malformed decode(Bytes bytes, body_state_t& message) {
  if (const Malformed reason = check_start<body_state_t>(bytes, kMaxStreamBytes); reason != Malformed::none)
    return reason;
  constexpr std::size_t before_name = kFingerprint + 4 * 8 + 2 * 4 + 1;
  constexpr std::size_t after_name = (3 + 4 + 3 + 3 + 3 + 2) * 8;
  const Malformed reason = Walker(bytes).fixed(before_name).text(kMaxBodyName).fixed(after_name).end();
  return reason == Malformed::none ? decode_checked(bytes, message) : reason;
}

Malformed decode(Bytes bytes, catalog_t& message) {
  if (const Malformed reason = check_start<catalog_t>(bytes, kMaxStreamBytes); reason != Malformed::none)
    return reason;
  std::size_t bodies = 0, shapes = 0, vertices = 0;
  Walker walker(bytes);
  walker.fixed(kFingerprint + 3 * 8 + 4 * 4).count(bodies).fixed(bodies * 2 * 4).texts(bodies, kMaxBodyName);
  walker.fixed(bodies * (1 + 4 + 10 * 8));
  walker.count(shapes).fixed(shapes * (2 * 4 + 1 + 4 + 10 * 8 + 6 * 4));
  walker.count(vertices).fixed(vertices * 6 * 4);
  return walker.end() == Malformed::none ? decode_checked(bytes, message) : walker.end();
}

Malformed decode(Bytes bytes, contacts_t& message) {
  if (const Malformed reason = check_start<contacts_t>(bytes, kMaxStreamBytes); reason != Malformed::none)
    return reason;
  std::size_t n = 0;
  Walker walker(bytes);
  walker.fixed(kFingerprint + 4 * 8 + 4 + 2 * 2).count(n).fixed(n * (2 * 4 + 10 * 8));
  return walker.end() == Malformed::none ? decode_checked(bytes, message) : walker.end();
}

Malformed decode(Bytes bytes, ack_t& message) {
  if (const Malformed reason = check_start<ack_t>(bytes, kMaxStreamBytes); reason != Malformed::none)
    return reason;
  std::size_t n = 0;
  Walker walker(bytes);
  walker.fixed(kFingerprint + 3 * 8).count(n).fixed(n * (3 * 8 + 1 + 2 * 4)).texts(n, kMaxAckDetail);
  return walker.end() == Malformed::none ? decode_checked(bytes, message) : walker.end();
}

Malformed decode(Bytes bytes, hits_t& message) {
  if (const Malformed reason = check_start<hits_t>(bytes, kMaxStreamBytes); reason != Malformed::none)
    return reason;
  std::size_t n = 0;
  Walker walker(bytes);
  walker.fixed(kFingerprint + 6 * 8 + 1).text(kMaxAckDetail).fixed(4).count(n).fixed(n * (3 * 4 + 7 * 8 + 1));
  return walker.end() == Malformed::none ? decode_checked(bytes, message) : walker.end();
}

Malformed decode(Bytes bytes, pushes_t& message) {
  if (const Malformed reason = check_start<pushes_t>(bytes, kMaxStreamBytes); reason != Malformed::none)
    return reason;
  std::size_t n = 0;
  Walker walker(bytes);
  walker.fixed(kFingerprint + 4 * 8 + 4).count(n).fixed(n * (4 + 10 * 8));
  return walker.end() == Malformed::none ? decode_checked(bytes, message) : walker.end();
}

Malformed decode(Bytes bytes, packed_t& message) {
  if (const Malformed reason = check_start<packed_t>(bytes, kMaxStreamBytes); reason != Malformed::none)
    return reason;
  std::size_t size = 0;
  Walker walker(bytes);
  walker.fixed(kFingerprint + 6 * 8 + 4 + 2 * 2 + 4 * 8 + 4);
  const std::size_t count_at = kFingerprint + 6 * 8 + 4 + 2 * 2 + 4 * 8 + 4;
  walker.fixed(4).count(size).fixed(size);
  if (walker.end() != Malformed::none) return walker.end();
  if (std::size_t{read_u32(bytes, count_at)} * kPackedRecord != size) return Malformed::too_short;
  return decode_checked(bytes, message);
}

}  // namespace tumble
