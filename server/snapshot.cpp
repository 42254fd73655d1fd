// See snapshot.h. One list of members a type, as in world/archive.cpp.
#include "snapshot.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <memory>
#include <stdexcept>
#include <tuple>
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

/// Overwrites `bytes`.
template <typename Object>
void write_bytes(const Object& object, std::string& bytes) {
  OutputArchive archive(bytes);
  archive(object);
}
template <typename Object>
void read_bytes(const std::string& bytes, Object& object) {
  InputArchive archive(bytes);
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
  /// But for the worlds, whose bytes stand apart.
  static void members(auto& archive, Simulation& simulation) {
    auto& [start, now, kept, session, start_sums, paused, steps_wanted, watched, contacts_wanted,
           pushes_wanted] = simulation;
    archive(now.pushes, session, start_sums, paused, steps_wanted, watched, contacts_wanted, pushes_wanted);
  }
  static void set_worlds(Simulation& simulation, World now, Simulation::KeptStates kept) {
    simulation.now_.world = std::move(now);
    simulation.kept_ = std::move(kept);
  }
};

namespace {

/// By name: the bytes of the world, and its pushes.
using KeptBytes = std::map<std::string, std::pair<std::string, std::vector<Simulation::ActivePush>>>;

Simulation::KeptStates read_kept(const std::string& bytes, const World& start) {
  KeptBytes read;
  read_bytes(bytes, read);
  Simulation::KeptStates kept;
  for (auto& [name, state] : read) {
    kept.emplace(name, std::make_shared<const Simulation::State>(
                           Simulation::State{read_world(start, state.first), std::move(state.second)}));
  }
  return kept;
}

}  // namespace

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

void take_snapshot(const Simulation& simulation, const CommandInbox& inbox, Snapshot& snapshot) {
  snapshot.session = simulation.session();
  snapshot.step = simulation.now_step();
  snapshot.state_hash = std::bit_cast<std::int64_t>(simulation.world().state_hash());
  write_world(simulation.world(), simulation.start()->world, snapshot.world);
  write_bytes(simulation, snapshot.simulation);
  write_bytes(inbox, snapshot.inbox);
}

void add_kept(const Simulation::KeptStates& kept, const Simulation::State& start, Snapshot& snapshot) {
  KeptBytes bytes;
  for (const auto& [name, state] : kept) {
    auto& [world, pushes] = bytes[name];
    write_world(state->world, start.world, world);
    pushes = state->pushes;
  }
  write_bytes(bytes, snapshot.kept);
}

Snapshot take_whole_snapshot(const Simulation& simulation, const CommandInbox& inbox) {
  Snapshot snapshot;
  take_snapshot(simulation, inbox, snapshot);
  add_kept(simulation.kept(), *simulation.start(), snapshot);
  return snapshot;
}

bool is_same_state(const Snapshot& a, const Snapshot& b) {
  return a.world == b.world && a.simulation == b.simulation && a.kept == b.kept;
}

void restore(const Snapshot& snapshot, Simulation& simulation, CommandInbox& inbox) {
  try {
    const World& start = simulation.start()->world;
    Archived<Simulation>::set_worlds(simulation, read_world(start, snapshot.world),
                                     read_kept(snapshot.kept, start));
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
  std::string bytes;
  write_bytes(std::tie(snapshot.world, snapshot.simulation, snapshot.kept, snapshot.inbox), bytes);
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
  Snapshot snapshot;
  snapshot.session = head_.session;
  snapshot.step = head_.step;
  snapshot.state_hash = head_.state_hash;
  auto strings = std::tie(snapshot.world, snapshot.simulation, snapshot.kept, snapshot.inbox);
  read_bytes(bytes_, strings);
  return snapshot;
}

}  // namespace tumble
