// See traffic_claims.h.
#include "traffic_claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <string_view>
#include <utility>
#include <variant>

#include "net/command_inbox.h"
#include "net/command_socket.h"
#include "simulation.h"

namespace tumble::test {
namespace {

constexpr std::int64_t kSession = 1;
constexpr std::size_t kFingerprint = 8;
enum Kind { datagram, force, control, other, tick, kinds };

using OtherMessage =
    std::variant<heartbeat_t, state_t, stats_t, body_state_t, catalog_t, contacts_t, ack_t, packed_t,
                 pushes_t, query_t, hits_t, recording_t, step_record_t, snapshot_t>;

World make_world() {
  World world;
  BodyDefinition floor, ball;
  floor.name = "floor";
  floor.type = BodyType::fixed;
  floor.geometries.emplace_back().shape = HalfSpace{};
  ball.name = "ball";
  ball.X_WL.p = Vec3(0.0, 0.0, 2.0);
  ball.geometries.emplace_back().shape = Sphere{0.5};
  world.create_body(floor);
  world.create_body(ball);
  return world;
}

template <typename Message>
std::vector<std::uint8_t> with_fingerprint(Bytes content) {
  std::vector<std::uint8_t> bytes;
  encode(Message{}, bytes);
  bytes.resize(kFingerprint);
  bytes.insert(bytes.end(), content.begin(), content.end());
  return bytes;
}

OtherMessage make_other(std::size_t type) {
  static constexpr auto makers = []<std::size_t... index>(std::index_sequence<index...>) {
    return std::array{+[] { return OtherMessage(std::in_place_index<index>); }...};
  }
  (std::make_index_sequence<std::variant_size_v<OtherMessage>>());
  return makers[type % makers.size()]();
}

/// One server without a bus.
class Traffic {
 public:
  Traffic() : simulation_(make_world(), kSession) { inbox_.set_now(kSession, 0); }

  void receive(std::uint8_t kind, Bytes content) {
    switch (kind % kinds) {
      case datagram:
        return receive_datagram(content);
      case force:
        return receive_command<force_command_t>(with_fingerprint<force_command_t>(content));
      case control:
        return receive_command<control_t>(with_fingerprint<control_t>(content));
      case other:
        return std::visit(
            [&]<typename Message>(Message message) {
              check_decoding(with_fingerprint<Message>(content), message);
            },
            make_other(kind / kinds));
      default:
        return make_tick();
    }
  }
  const TrafficVerdict& verdict() const { return verdict_; }

 private:
  void claim(bool holds, const char* what, std::int64_t value) {
    if (!holds && verdict_.broken.empty()) verdict_.broken = fmt::format("{} ({})", what, value);
  }

  /// What decodes says nothing that its bytes do not say.
  template <typename Message>
  void check_decoding(Bytes bytes, Message message) {
    if (decode(bytes, message) != Malformed::none) return;
    ++verdict_.decoded;
    std::vector<std::uint8_t> again;
    encode(message, again);
    claim(std::ranges::equal(bytes, again), "a message is not the same when encoded again",
          static_cast<std::int64_t>(bytes.size()));
  }

  template <typename Message>
  void receive_command(Bytes bytes) {
    check_decoding(bytes, Message{});
    if constexpr (std::is_same_v<Message, force_command_t>) {
      inbox_.receive_force(bytes);
    } else {
      inbox_.receive_control(bytes);
    }
    claim(inbox_.pending() <= CommandInbox::kMaxPending, "more wait than there is room for",
          static_cast<std::int64_t>(inbox_.pending()));
  }

  void receive_datagram(Bytes content) {
    const std::string_view text(reinterpret_cast<const char*>(content.data()), content.size());
    const auto message = parse_datagram(text);
    if (!message) return;
    const Bytes payload(reinterpret_cast<const std::uint8_t*>(message->payload.data()),
                        message->payload.size());
    if (message->channel.ends_with(kForceSuffix)) return receive_command<force_command_t>(payload);
    if (message->channel.ends_with(kControlSuffix)) return receive_command<control_t>(payload);
    check_decoding(payload, query_t{});
  }

  void make_tick() {
    inbox_.set_now(simulation_.session(), simulation_.now_step());
    std::set<std::pair<std::int64_t, std::int64_t>> due;
    for (const Command& command : inbox_.take_due()) {
      due.emplace(command.client, command.sequence);
      claim(taken_.emplace(command.client, command.sequence).second, "a command acts twice",
            command.sequence);
      apply(command);
    }
    for (const Acknowledgement& answer : inbox_.take_answers()) {
      claim(answer.client != 0 && answer.sequence > 0, "an answer to nobody", answer.client);
      if (answer.outcome.status != Status::queued) due.erase({answer.client, answer.sequence});
    }
    claim(due.empty(), "commands were not answered", static_cast<std::int64_t>(due.size()));
    simulation_.step();
    for (std::uint32_t slot = 0; slot < simulation_.world().body_capacity(); ++slot) {
      const Motion motion = simulation_.world().motion(slot);
      claim(motion.x.allFinite() && motion.v.allFinite() && motion.L.allFinite() &&
                motion.q.coeffs().allFinite(),
            "a body is not finite", slot);
    }
  }

  void apply(const Command& command) {
    const std::int64_t session = simulation_.session();
    const auto outcome = simulation_.apply(command);
    verdict_.applied += outcome.status == Status::applied;
    inbox_.settle(command, outcome);
    if (simulation_.session() == session) return;
    inbox_.cancel_pending();
    inbox_.set_now(simulation_.session(), simulation_.now_step());
  }

  Simulation simulation_;
  CommandInbox inbox_;
  std::set<std::pair<std::int64_t, std::int64_t>> taken_;  // fewer than the histories hold
  TrafficVerdict verdict_;
};

/// Appends records.
class Recording {
 public:
  void put(Kind kind, Bytes content) {
    bytes_.push_back(static_cast<std::uint8_t>(kind));
    bytes_.push_back(static_cast<std::uint8_t>(content.size() >> 8));
    bytes_.push_back(static_cast<std::uint8_t>(content.size()));
    bytes_.insert(bytes_.end(), content.begin(), content.end());
  }
  template <typename Command>
  void put_command(Command command) {
    command.client = 7;
    command.sequence = ++sequence_;
    std::vector<std::uint8_t> message;
    encode(command, message);
    put(std::is_same_v<Command, force_command_t> ? force : control, Bytes(message).subspan(kFingerprint));
    put(tick, {});
  }
  /// The same once more as it comes from the wire.
  void put_datagram(std::string_view channel, const force_command_t& command) {
    std::vector<std::uint8_t> message;
    encode(command, message);
    std::string text = "LC02" + std::string(4, '\0') + std::string(channel) + '\0';
    text.append(message.begin(), message.end());
    put(datagram, Bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
    put(tick, {});
  }
  std::vector<std::uint8_t> bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
  std::int64_t sequence_ = 0;
};

control_t make_control(std::int8_t verb) {
  control_t command{};
  command.verb = verb;
  command.name = "box";
  command.count = 1;
  command.body = command.generation = 1;
  command.body_type = catalog_t::TYPE_DYNAMIC;
  command.shape_type = catalog_t::SHAPE_BOX;
  std::ranges::fill(command.size, 1.0);
  command.position[2] = 4.0;
  command.orientation[0] = 1.0;
  return command;
}

}  // namespace

TrafficVerdict check_traffic(Bytes input) {
  Traffic traffic;
  while (input.size() >= 3) {
    const std::uint8_t kind = input[0];
    const std::size_t length = std::min<std::size_t>(input[1] << 8 | input[2], input.size() - 3);
    traffic.receive(kind, input.subspan(3, length));
    input = input.subspan(3 + length);
  }
  return traffic.verdict();
}

std::vector<std::uint8_t> sound_traffic() {
  Recording recording;
  force_command_t push{};
  push.body = push.generation = 1;
  push.force[0] = 3.0;
  push.duration = 0.1;
  recording.put_command(push);
  for (std::int8_t verb = control_t::VERB_SPAWN; verb <= control_t::VERB_PUSHES_OFF; ++verb) {
    recording.put_command(make_control(verb));
  }
  push.client = 8;
  push.sequence = 1;
  recording.put_datagram("TUMBLE_FORCE", push);
  return recording.bytes();
}

}  // namespace tumble::test
