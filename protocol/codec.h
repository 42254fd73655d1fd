// Bytes <-> messages. What comes from the network is read only here: the length is checked before decoding, the whole
// buffer must be consumed, counts are bounded before anything is allocated, every number must be finite. The generated
// decoders check none of that (a count in a 28-byte message can make them allocate gigabytes).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/channels.h"
#include "tumble/ack_t.hpp"
#include "tumble/body_state_t.hpp"
#include "tumble/catalog_t.hpp"
#include "tumble/contacts_t.hpp"
#include "tumble/control_t.hpp"
#include "tumble/force_command_t.hpp"
#include "tumble/heartbeat_t.hpp"
#include "tumble/hits_t.hpp"
#include "tumble/packed_t.hpp"
#include "tumble/pushes_t.hpp"
#include "tumble/query_t.hpp"
#include "tumble/recording_t.hpp"
#include "tumble/snapshot_t.hpp"
#include "tumble/state_t.hpp"
#include "tumble/stats_t.hpp"
#include "tumble/step_record_t.hpp"

namespace tumble {

/// Why bytes are not a message. Counted by reason; `none` is success.
enum class Malformed : std::uint8_t {
  none,
  too_short,          ///< Ends before the message does.
  too_long,           ///< Longer than any message of this type, or bytes are left over.
  wrong_fingerprint,  ///< Another type, or another version of the type.
  bad_text,           ///< A string whose length or end is wrong, or longer than its limit.
  count
};
const char* malformed_text(Malformed reason);

/// Who sent a command, readable from its fixed start even where the rest is damaged, so that it can be answered.
struct Sender {
  std::int64_t client = 0, sequence = 0;  ///< 0: unknown.
};

using Bytes = std::span<const std::uint8_t>;

/// Decode `bytes` into `message`; on any reason but `none` its content is undefined. Never throws, never allocates
/// more than the bytes hold. Numbers may be non-finite: see `find_not_finite`.
Malformed decode(Bytes bytes, force_command_t& message);
Malformed decode(Bytes bytes, control_t& message);
Malformed decode(Bytes bytes, heartbeat_t& message);
Malformed decode(Bytes bytes, state_t& message);
Malformed decode(Bytes bytes, stats_t& message);
Malformed decode(Bytes bytes, body_state_t& message);
Malformed decode(Bytes bytes, catalog_t& message);
Malformed decode(Bytes bytes, contacts_t& message);
Malformed decode(Bytes bytes, ack_t& message);
Malformed decode(Bytes bytes, packed_t& message);
Malformed decode(Bytes bytes, pushes_t& message);
Malformed decode(Bytes bytes, query_t& message);
Malformed decode(Bytes bytes, hits_t& message);
Malformed decode(Bytes bytes, recording_t& message);
Malformed decode(Bytes bytes, step_record_t& message);
Malformed decode(Bytes bytes, snapshot_t& message);

/// The sender of a force_command_t or control_t that `decode` refused; {0, 0} if the bytes don't name one.
Sender read_sender(Bytes bytes);

/// Name of the first field with a number that is not finite; null if there is none.
const char* find_not_finite(const force_command_t& command);
const char* find_not_finite(const control_t& command);
const char* find_not_finite(const query_t& query);

/// The message as bytes, fingerprint first; `bytes` keeps its capacity.
template <typename Message>
void encode(const Message& message, std::vector<std::uint8_t>& bytes) {
  const int size = message.getEncodedSize();
  bytes.resize(static_cast<std::size_t>(size));
  message.encode(bytes.data(), 0, size);
}

}  // namespace tumble
