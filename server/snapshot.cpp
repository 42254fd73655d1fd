// See snapshot.h. One list of members a type, as in world/archive.cpp.
#include "snapshot.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "math/archive.h"
#include "math/hash.h"
#include "protocol/layout.h"
#include "world/archive.h"

namespace tumble {
namespace {

/// Of a part's data: what is left of the limit by its other fields.
constexpr std::size_t kPartBytes = kLoopbackPayload - 80;

std::int64_t compute_checksum(const snapshot_t& part) {
  Hash hash;
  for (const std::int64_t field :
       {part.utime, part.session, part.step, part.state_hash, std::int64_t{part.part},
        std::int64_t{part.num_parts}, std::int64_t{part.size}}) {
    hash.add(static_cast<std::uint64_t>(field));
  }
  const Bytes data(part.data);
  std::size_t at = 0;
  for (; at + 8 <= data.size(); at += 8) hash.add(read_u64(data, at));
  std::uint64_t rest = 0;
  for (const std::uint8_t byte : data.subspan(at)) rest = rest << 8 | byte;
  if (at < data.size()) hash.add(rest);
  return static_cast<std::int64_t>(hash.value());
}

template <typename Archive>
constexpr bool kReads = Archive::is_loading::value;

template <typename Object>
std::string bytes_of(const Object& object) {
  std::ostringstream out;
  OutputArchive archive(out);
  archive(object);
  return std::move(out).str();
}
template <typename Object>
void read_bytes(const std::string& bytes, Object& object) {
  std::istringstream in(bytes);
  InputArchive archive(in);
  archive(object);
}

}  // namespace

template <typename Archive, typename Message>
requires std::is_same_v<Message, force_command_t> || std::is_same_v<Message, control_t>
void serialize(Archive& archive, Message& message) {
  std::vector<std::uint8_t> bytes;
  if constexpr (!kReads<Archive>) encode(message, bytes);
  archive(bytes);
  if (kReads<Archive> && decode(bytes, message) != Malformed::none)
    throw std::runtime_error("a command in it is malformed");
}

// The simulation

template <typename Archive>
void serialize(Archive& archive, Conserved& sums) {
  auto& [kinetic_energy, potential_energy, momentum, angular_momentum] = sums;
  archive(kinetic_energy, potential_energy, momentum, angular_momentum);
}
template <>
struct Archived<Simulation::ActivePush> {
  /// Of the command what a picture of the push shows: in a log it has another session and start than on the wire.
  static void members(auto& archive, auto& active) {
    auto& [command, end] = active;
    archive(command.body, command.generation, command.frame, command.force, command.torque, command.point,
            end);
  }
};
template <>
struct Archived<Simulation> {
  template <typename Archive>
  static void members(Archive& archive, Simulation& simulation) {
    auto& [start, now, snapshots, session, start_sums, paused, steps_wanted, watched, contacts_wanted,
           pushes_wanted] = simulation;
    archive(session, start_sums, paused, steps_wanted, watched, contacts_wanted, pushes_wanted);
    state(archive, start.world, now);  // `start` is the scene's
    std::vector<std::string> names;
    if (kReads<Archive>) snapshots.clear();
    for (const auto& [name, kept] : snapshots) names.push_back(name);
    archive(names);
    for (const std::string& name : names) state(archive, start.world, snapshots[name]);
  }

 private:
  template <typename Archive>
  static void state(Archive& archive, const World& start, Simulation::State& state) {
    auto& [world, pushes] = state;
    std::stringstream bytes;
    if (!kReads<Archive>) write_world(world, start, bytes);
    std::string text = std::move(bytes).str();
    archive(text, pushes);
    if (kReads<Archive>) {
      std::istringstream in(text);
      world = read_world(start, in);
    }
  }
};

// The inbox

template <typename Archive>
void serialize(Archive& archive, Outcome& outcome) {
  auto& [status, step, body, generation, detail] = outcome;
  archive(status, step, body, generation, detail);
}
template <>
struct Archived<ClientHistory::Client> {
  static void members(auto& archive, auto& client) {
    auto& [heard, outcomes] = client;
    archive(heard, outcomes);
  }
};
template <>
struct Archived<ClientHistory> {
  static void members(auto& archive, ClientHistory& history) {
    auto& [clients, arrivals] = history;
    archive(clients, arrivals);
  }
};
template <typename Archive>
void serialize(Archive& archive, Command& command) {
  auto& [client, sequence, session, expiry_step, content] = command;
  archive(client, sequence, session, expiry_step, content);
}
template <>
struct Archived<CommandInbox> {
  static void members(auto& archive, CommandInbox& inbox) {
    // Answers have been taken, counters start anew, the observer is the server's.
    auto& [session, step, history, pending, answers, unanswered, counters, observer] = inbox;
    archive(session, step, history, pending);
  }
};

Snapshot take_snapshot(const Simulation& simulation, const CommandInbox& inbox) {
  return {.session = simulation.session(),
          .step = simulation.now_step(),
          .state_hash = std::bit_cast<std::int64_t>(simulation.world().state_hash()),
          .simulation = bytes_of(simulation),
          .inbox = bytes_of(inbox)};
}

void restore(const Snapshot& snapshot, Simulation& simulation, CommandInbox& inbox) {
  try {
    read_bytes(snapshot.simulation, simulation);
    read_bytes(snapshot.inbox, inbox);
  } catch (const std::exception& error) {  // cereal's, or of an allocation that nobody can have asked for
    throw std::runtime_error(fmt::format("it can't be read: {}", error.what()));
  }
  const auto hash = std::bit_cast<std::int64_t>(simulation.world().state_hash());
  if (simulation.session() != snapshot.session || simulation.now_step() != snapshot.step ||
      hash != snapshot.state_hash) {
    throw std::runtime_error("another world comes out of it");
  }
}

void send_parts(const Snapshot& snapshot, std::int64_t utime,
                const std::function<void(const snapshot_t&)>& send) {
  const std::string bytes = bytes_of(std::pair(snapshot.simulation, snapshot.inbox));
  snapshot_t part{};
  part.utime = utime;
  part.session = snapshot.session;
  part.step = snapshot.step;
  part.state_hash = snapshot.state_hash;
  part.num_parts = static_cast<std::int32_t>((bytes.size() + kPartBytes - 1) / kPartBytes);
  for (; part.part < part.num_parts; ++part.part) {
    const std::size_t begin = static_cast<std::size_t>(part.part) * kPartBytes;
    const std::size_t end = std::min(begin + kPartBytes, bytes.size());
    part.data.assign(bytes.begin() + static_cast<std::ptrdiff_t>(begin),
                     bytes.begin() + static_cast<std::ptrdiff_t>(end));
    part.size = static_cast<std::int32_t>(part.data.size());
    part.checksum = compute_checksum(part);
    send(part);
  }
}

bool SnapshotAssembly::add(const snapshot_t& part) {
  const snapshot_t before = std::exchange(head_, snapshot_t{});
  if (part.checksum != compute_checksum(part)) {
    throw std::runtime_error(fmt::format("a part of the snapshot after step {} is damaged", part.step));
  }
  const bool follows = part.part == before.part + 1 && part.num_parts == before.num_parts &&
                       part.session == before.session && part.step == before.step;
  if (part.part == 0) {
    bytes_.clear();
  } else if (!follows) {
    return false;
  }
  bytes_.append(part.data.begin(), part.data.end());
  head_ = part;
  return part.part + 1 == part.num_parts;
}

Snapshot SnapshotAssembly::snapshot() const {
  std::pair<std::string, std::string> both;
  read_bytes(bytes_, both);
  return {.session = head_.session,
          .step = head_.step,
          .state_hash = head_.state_hash,
          .simulation = std::move(both.first),
          .inbox = std::move(both.second)};
}

}  // namespace tumble
