// Connection, receiving and resending, see world.h. The commands are in world_commands.cpp.
#include "tumble/world.h"

#include <algorithm>
#include <fstream>
#include <random>

#include "protocol/bus_probe.h"

namespace tumble::client {
namespace {

/// Longest sleep in LCM, so that what `done` looks at is looked at again [ms].
constexpr int kSlice = 100;
/// Messages LCM keeps for us; its default of 30 is less than one burst of a large world.
constexpr int kQueueCapacity = 10000;
/// Receive buffer asked for: holds the bursts of a world of several thousand bodies [B].
constexpr int kReceiveBuffer = 4 << 20;

std::int64_t make_client_id() {
  std::random_device random;
  const std::uint64_t high = random(), low = random();
  return static_cast<std::int64_t>((high << 32 | low) | 1);  // never 0
}

/// The URL with a larger receive buffer, no more than the kernel grants: LCM complains on stderr otherwise.
std::string with_receive_buffer(const BusAddress& address) {
  if (!address.is_multicast() || address.receive_buffer > 0) return address.url;
  int granted = 0;
  std::ifstream("/proc/sys/net/core/rmem_max") >> granted;
  if (granted <= 0) return address.url;
  const char separator = address.url.find('?') == std::string::npos ? '?' : '&';
  return address.url + separator + "recv_buf_size=" + std::to_string(std::min(granted, kReceiveBuffer));
}

std::shared_ptr<lcm::LCM> open_bus(const std::string& url) {
  const BusAddress address = parse_bus_url(url);
  const BusReport report = probe_bus(address);
  if (!report.works()) throw BusError(report.what, report.repair);
  auto bus = std::make_shared<lcm::LCM>(with_receive_buffer(address));
  if (!bus->good()) throw BusError("LCM can't open " + address.url, "tumble doctor");
  return bus;
}

}  // namespace

World::World(const WorldOptions& options) : World(open_bus(options.url), options) {
  url_ = parse_bus_url(options.url).url;
}

World::World(std::shared_ptr<lcm::LCM> bus, const WorldOptions& options)
    : options_(options), url_(options.url), bus_(std::move(bus)), outbox_(make_client_id(), options.timing) {
  if (!is_world_name(options_.name)) {
    throw std::invalid_argument("world name \"" + options_.name + "\": 1 to " +
                                std::to_string(kMaxWorldName) + " letters, digits or underscores");
  }
  subscribe();
}

World::~World() {
  for (lcm::Subscription* subscription : subscriptions_) bus_->unsubscribe(subscription);
}

void World::subscribe() {
  const auto listen = [this](std::string_view suffix, auto handler) {
    lcm::Subscription* subscription = bus_->subscribe(channel_name(name(), suffix), handler, this);
    if (!subscription) throw BusError("LCM's self test failed on " + url_, "tumble doctor");
    subscription->setQueueCapacity(kQueueCapacity);
    subscriptions_.push_back(subscription);
  };
  listen(kStateSuffix, &World::on_state);
  listen(kCatalogSuffix, &World::on_catalog);
  listen(kHeartbeatSuffix, &World::on_heartbeat);
  listen(kStatsSuffix, &World::on_stats);
  listen(kAckSuffix, &World::on_ack);
  listen(kPackedSuffix, &World::on_packed);
  listen(kContactsSuffix, &World::on_contacts);
  listen(kHitsSuffix, &World::on_hits);
}

template <typename Message, typename Use>
void World::receive(const lcm::ReceiveBuffer* buffer, Use use) {
  Message message;
  const Bytes bytes(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
  if (decode(bytes, message) == Malformed::none) {
    use(message);
  } else {
    ++messages_malformed_;
  }
}

void World::on_state(const lcm::ReceiveBuffer* buffer, const std::string&) {
  receive<state_t>(buffer, [this](const state_t& message) { picture_.merge(message); });
}
void World::on_catalog(const lcm::ReceiveBuffer* buffer, const std::string&) {
  receive<catalog_t>(buffer, [this](const catalog_t& message) { picture_.merge(message); });
}
void World::on_heartbeat(const lcm::ReceiveBuffer* buffer, const std::string&) {
  receive<heartbeat_t>(buffer, [this](const heartbeat_t& message) { heartbeat_ = message; });
}
void World::on_stats(const lcm::ReceiveBuffer* buffer, const std::string&) {
  receive<stats_t>(buffer, [this](const stats_t& message) { stats_ = message; });
}
void World::on_ack(const lcm::ReceiveBuffer* buffer, const std::string&) {
  receive<ack_t>(buffer, [this](const ack_t& message) { outbox_.receive(message); });
}

void World::on_packed(const lcm::ReceiveBuffer* buffer, const std::string&) {
  receive<packed_t>(buffer, [this](const packed_t& message) { picture_.merge(message); });
}
void World::on_contacts(const lcm::ReceiveBuffer* buffer, const std::string&) {
  receive<contacts_t>(buffer, [this](const contacts_t& message) { contacts_.merge(message); });
}
void World::on_hits(const lcm::ReceiveBuffer* buffer, const std::string&) {
  receive<hits_t>(buffer, [this](const hits_t& message) {
    if (message.client == outbox_.client()) hits_ = message;
  });
}

void World::spin(double seconds) {
  spin_until([] { return false; }, seconds);
}

bool World::spin_until(const std::function<bool()>& done, double seconds) {
  using Clock = Outbox::Clock;
  const auto end =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  while (true) {
    send_due();
    for (int handled = 0; handled < kQueueCapacity && bus_->handleTimeout(0) > 0; ++handled) {
    }
    if (done()) return true;
    const auto now = Clock::now();
    if (now >= end) return false;
    const auto wake = std::min({end, outbox_.next_due(), now + std::chrono::milliseconds(kSlice)});
    const auto sleep = std::chrono::ceil<std::chrono::milliseconds>(wake - now).count();
    bus_->handleTimeout(static_cast<int>(std::max<std::int64_t>(sleep, 0)));
  }
}

void World::wait_for_server(double seconds) {
  if (!spin_until([this] { return heartbeat_.has_value(); }, seconds)) {
    const std::string where = url_.empty() ? "" : " at " + url_;  // none: the caller's own bus
    throw NoServer("no server answers on channel " + channel_name(name(), kHeartbeatSuffix) + where);
  }
  if (heartbeat_->protocol_version != kProtocolVersion) {
    throw std::runtime_error("the server on " + heartbeat_->host + " speaks protocol version " +
                             std::to_string(heartbeat_->protocol_version) + ", this client " +
                             std::to_string(kProtocolVersion));
  }
}

void World::wait_for_picture(double seconds) {
  wait_for_server(seconds);
  if (!spin_until([this] { return picture_.is_complete(); }, seconds)) {
    throw NoServer("the picture of " + name() + " did not become complete (" +
                   std::to_string(picture_.bodies().size()) + " of " + std::to_string(picture_.num_bodies()) +
                   " bodies heard of)");
  }
}

const Body& World::wait_for_body(const std::string& name, double seconds) {
  const auto ready = [&] {
    const Body* body = picture_.find(name);
    return (body && body->placed) || picture_.is_complete();
  };
  wait_for_server(seconds);
  spin_until(ready, seconds);
  const Body* body = picture_.find(name);
  if (body && body->placed) return *body;
  if (!picture_.is_complete()) {
    throw NoServer("the server is there, but no description of \"" + name + "\" came within the time limit");
  }
  std::vector<std::string> known;
  for (const auto& [id, other] : picture_.bodies()) known.push_back(other.name);
  std::string message = "no body is called \"" + name + "\"";
  const auto similar = similar_names(name, known);
  for (std::size_t i = 0; i < similar.size(); ++i) message += (i ? ", " : "; similar: ") + similar[i];
  throw std::invalid_argument(message);
}

void World::send_due() {
  for (const Outbox::Command* command : outbox_.take_due(Outbox::Clock::now())) {
    bus_->publish(command->channel, command->bytes.data(), static_cast<unsigned>(command->bytes.size()));
  }
}

Answer World::wait(std::int64_t sequence) {
  spin_until([&] { return outbox_.answer(sequence) != nullptr; }, time_limit() + 1.0);
  const Answer* answer = outbox_.answer(sequence);
  Answer result = answer ? *answer : Answer{};
  outbox_.forget(sequence);
  return result;
}

double World::time_limit() const {
  return std::chrono::duration<double>(options_.timing.limit).count();
}

}  // namespace tumble::client
