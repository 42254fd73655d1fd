// The names and numbers of the wire that the .lcm files cannot say: channels, version, limits, answers to commands.
// protocol/README.md is the standard in words. Depends on nothing, so clients include it too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace tumble {

/// Rises with every change that an older client would misread.
inline constexpr std::int32_t kProtocolVersion = 1;

inline constexpr std::string_view kDefaultWorld = "TUMBLE";

// A channel is the world's name and one of these. Server to clients:
inline constexpr std::string_view kStateSuffix = "_STATE";        ///< state_t
inline constexpr std::string_view kStatsSuffix = "_STATS";        ///< stats_t
inline constexpr std::string_view kBodySuffix = "_BODY_";         ///< body_state_t; the body's index follows
inline constexpr std::string_view kContactsSuffix = "_CONTACTS";  ///< contacts_t
inline constexpr std::string_view kCatalogSuffix = "_CATALOG";    ///< catalog_t
inline constexpr std::string_view kHeartbeatSuffix = "_HEARTBEAT";  ///< heartbeat_t
inline constexpr std::string_view kAckSuffix = "_ACK";              ///< ack_t
inline constexpr std::string_view kPackedSuffix = "_PACKED";        ///< packed_t, instead of state_t
inline constexpr std::string_view kPushesSuffix = "_PUSHES";        ///< pushes_t
inline constexpr std::string_view kHitsSuffix = "_HITS";            ///< hits_t
// Clients to server:
inline constexpr std::string_view kForceSuffix = "_FORCE";      ///< force_command_t
inline constexpr std::string_view kControlSuffix = "_CONTROL";  ///< control_t
inline constexpr std::string_view kQuerySuffix = "_QUERY";      ///< query_t

// In logs only:
inline constexpr std::string_view kRecordingSuffix = "_RECORDING";  ///< recording_t
inline constexpr std::string_view kStepSuffix = "_STEP";            ///< step_record_t
inline constexpr std::string_view kSnapshotSuffix = "_SNAPSHOT";    ///< snapshot_t

inline std::string channel_name(std::string_view world, std::string_view suffix) {
  return std::string(world).append(suffix);
}
inline std::string body_channel_name(std::string_view world, std::int32_t id) {
  return channel_name(world, kBodySuffix) + std::to_string(id);
}

/// 1..40 of A-Z a-z 0-9 _: LCM takes channels up to 63 bytes, the longest suffix is "_BODY_" and ten digits.
inline constexpr std::size_t kMaxWorldName = 40;
inline bool is_world_name(std::string_view name) {
  if (name.empty() || name.size() > kMaxWorldName) return false;
  for (const char c : name) {
    const bool letter = (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
    if (!letter && !(c >= '0' && c <= '9') && c != '_') return false;
  }
  return true;
}

/// Bytes of a message where it may cross a network (ttl >= 1): with the headers of LCM, UDP and IP one Ethernet frame,
/// so that a lost frame costs one message. Of a 60 kB message 93 % are lost when 1 % of the frames are.
inline constexpr std::size_t kNetworkPayload = 1400;
/// The same on the loopback (ttl = 0), where nothing is cut: one UDP datagram.
inline constexpr std::size_t kLoopbackPayload = 60000;
/// Longest message the server reads: commands are far smaller.
inline constexpr std::size_t kMaxCommandBytes = 1400;

// Limits of values in commands. Beyond them a command is refused with Status::out_of_range.
inline constexpr double kMaxForce = 1e12;                  ///< |component| [N]
inline constexpr double kMaxTorque = 1e12;                 ///< |component| [N m]
inline constexpr double kMaxPoint = 1e6;                   ///< |component|, from the centre of mass [m]
inline constexpr double kMaxDuration = 1e6;                ///< [s]
inline constexpr double kMaxPosition = 1e6;                ///< |component| in W [m]
inline constexpr double kMaxVelocity = 1e5;                ///< |component| [m/s]
inline constexpr double kMaxAngularVelocity = 1e5;         ///< |component| [rad/s]
inline constexpr double kMinSize = 1e-4, kMaxSize = 1e4;   ///< [m]
inline constexpr double kMinMass = 1e-9, kMaxMass = 1e12;  ///< [kg]
inline constexpr double kMaxFriction = 100.0;
inline constexpr std::int64_t kMaxStepCount = 1'000'000'000;
inline constexpr std::size_t kMaxBodyName = 63;    ///< bytes
inline constexpr std::size_t kMaxAckDetail = 120;  ///< bytes
inline constexpr std::size_t kMaxWatched = 32;     ///< bodies on channels of their own
inline constexpr std::size_t kMaxSnapshots = 16;   ///< worlds kept by name
inline constexpr std::size_t kPackedRecord = 25;   ///< bytes of a body in packed_t
/// A client's sequence may lag this far behind its highest one; older ones can no longer be told from repetitions.
inline constexpr std::int64_t kSequenceWindow = 1024;

// Rates, per second of wall time.
inline constexpr double kDefaultPublishRate = 60.0;
inline constexpr double kStatsRate = 10.0;
inline constexpr double kHeartbeatRate = 2.0;
inline constexpr double kContactsRate = 20.0;   ///< at most; of pushes, too
inline constexpr double kRefreshPeriod = 0.5;   ///< [s] in which every body is sent once, changed or not
inline constexpr double kCatalogPeriod = 0.75;  ///< [s] in which the whole catalogue is sent once

/// What became of a command: ack_t.status.
enum class Status : std::int8_t {
  applied = 0,
  queued = 1,
  unknown_body = 2,
  stale_generation = 3,
  not_finite = 4,
  out_of_range = 5,
  expired = 6,
  wrong_session = 7,
  queue_full = 8,
  unknown_verb = 9,
  invalid = 10,
  cancelled = 11,
  too_old = 12,
  malformed = 13,
};
inline constexpr std::int8_t kNumStatuses = 14;

/// One line for people.
constexpr const char* status_text(Status status) {
  switch (status) {
    case Status::applied:
      return "applied";
    case Status::queued:
      return "queued until its start step";
    case Status::unknown_body:
      return "no body has this index";
    case Status::stale_generation:
      return "the body with this index and generation was removed";
    case Status::not_finite:
      return "a number is infinite or not a number";
    case Status::out_of_range:
      return "a number is outside its range";
    case Status::expired:
      return "it came after its expiry step";
    case Status::wrong_session:
      return "it was meant for another session of the server";
    case Status::queue_full:
      return "too many commands wait";
    case Status::unknown_verb:
      return "the verb is not known";
    case Status::invalid:
      return "the world refused it";
    case Status::cancelled:
      return "a reset came before its start step";
    case Status::too_old:
      return "its sequence is too far behind the client's newest";
    case Status::malformed:
      return "the message is damaged";
  }
  return "unknown status";
}

}  // namespace tumble
