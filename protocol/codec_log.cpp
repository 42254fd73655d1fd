// The types that only logs hold, see codec.h.
#include "protocol/codec.h"
#include "protocol/layout.h"

namespace tumble {
namespace {

constexpr std::size_t kMaxSceneText = std::size_t{1} << 30;
constexpr std::size_t kMaxNote = 4096;  // bytes of a text for people

}  // namespace

Malformed decode(Bytes bytes, recording_t& message) {
  if (const Malformed reason = check_start<recording_t>(bytes, 2 * kMaxSceneText);
      reason != Malformed::none) {
    return reason;
  }
  Walker walker(bytes);
  walker.fixed(kFingerprint + 2 * 8 + 4).texts(3, kMaxNote).fixed(5 * 8).text(kMaxSceneText);
  const Malformed reason = walker.end();
  return reason == Malformed::none ? decode_checked(bytes, message) : reason;
}

Malformed decode(Bytes bytes, step_record_t& message) {
  constexpr std::size_t kSize = kFingerprint + 4 * 8 + 4 + 8;
  if (const Malformed reason = check_start<step_record_t>(bytes, kSize); reason != Malformed::none)
    return reason;
  return bytes.size() < kSize ? Malformed::too_short : decode_checked(bytes, message);
}

Malformed decode(Bytes bytes, snapshot_t& message) {
  if (const Malformed reason = check_start<snapshot_t>(bytes, kLoopbackPayload); reason != Malformed::none)
    return reason;
  Walker walker(bytes);
  std::size_t size = 0;
  walker.fixed(kFingerprint + 4 * 8 + 2 * 4).count(size).fixed(size).fixed(8);
  const Malformed reason = walker.end();
  return reason == Malformed::none ? decode_checked(bytes, message) : reason;
}

}  // namespace tumble
