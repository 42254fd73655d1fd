// See bus.h.
#include "net/bus.h"

#include <poll.h>

#include <system_error>

#include "protocol/bus_probe.h"

namespace tumble {
namespace {

/// Messages of one subscription that liblcm keeps for us; its default of 30 loses bursts.
constexpr int kQueueCapacity = 10000;

std::string describe(const BusAddress& address) {
  if (!address.is_multicast()) return address.url;
  return address.group + " port " + std::to_string(address.port);
}

/// Probes the bus; returns the name of the interface that is used.
std::string check_bus(const BusAddress& address) {
  const BusReport report = probe_bus(address);
  if (report.works()) return report.interface;
  std::string text = "the LCM bus at " + describe(address) + " can't be used: " + report.what;
  if (!report.interface.empty()) text += "\n  interface: " + report.interface;
  throw BusError(text + "\nrepair it with\n  " + report.repair);
}

}  // namespace

Bus::Bus(const BusAddress& address, const std::string& world)
    : address_(address),
      interface_(check_bus(address)),
      payload_limit_(address.is_multicast() && address.ttl > 0 ? kNetworkPayload : kLoopbackPayload) {
  if (address.is_multicast()) {
    try {
      socket_.emplace(address, channel_name(world, kStateSuffix));
    } catch (const std::system_error& error) {
      throw BusError("can't listen at " + describe(address) + ": " + error.what());
    }
  }
  lcm_ = lcm_create(address.url.c_str());
  if (lcm_ == nullptr) throw BusError("LCM can't open \"" + address.url + "\" (its reason stands above)");
  // A tcpq server that isn't there is only told by this; liblcm would abort in its first receive.
  if (address.provider == "tcpq" && lcm_get_fileno(lcm_) < 0) {
    lcm_destroy(lcm_);
    throw BusError("LCM can't reach \"" + address.url + "\"");
  }
}

Bus::~Bus() {
  lcm_destroy(lcm_);
}

bool Bus::publish(const std::string& channel, Bytes payload) {
  return lcm_publish(lcm_, channel.c_str(), payload.data(), static_cast<unsigned>(payload.size())) == 0;
}

void Bus::subscribe(const std::string& channel, Handler handler) {
  subscriptions_.push_back(std::make_unique<Subscription>(Subscription{channel, std::move(handler)}));
  if (socket_) return;
  lcm_subscription_t* added = lcm_subscribe(lcm_, channel.c_str(), &Bus::handle, subscriptions_.back().get());
  if (added == nullptr) throw BusError("LCM can't subscribe to " + channel + " at \"" + address_.url + "\"");
  lcm_subscription_set_queue_capacity(added, kQueueCapacity);
}

int Bus::receive(int budget) {
  if (!socket_) return receive_lcm(budget);
  return socket_->receive(budget, [this](std::string_view channel, Bytes payload) {
    for (const auto& subscription : subscriptions_) {
      if (subscription->channel == channel) subscription->handler(payload);
    }
  });
}

void Bus::wait(std::int64_t ns) const {
  constexpr std::int64_t kSecond = 1'000'000'000;
  pollfd waiting{.fd = socket_ ? socket_->fd() : lcm_get_fileno(lcm_), .events = POLLIN, .revents = 0};
  const timespec time{ns / kSecond, ns % kSecond};
  ::ppoll(&waiting, 1, &time, nullptr);
}

int Bus::receive_lcm(int budget) {
  if (subscriptions_.empty()) return 0;
  int count = 0;
  while (count < budget && lcm_handle_timeout(lcm_, 0) > 0) ++count;
  return count;
}

void Bus::handle(const lcm_recv_buf_t* buffer, const char*, void* subscription) noexcept {
  static_cast<Subscription*>(subscription)
      ->handler({static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
}

}  // namespace tumble
