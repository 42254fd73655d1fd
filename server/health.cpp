// See health.h.
#include "health.h"

#include <chrono>

#include "host_name.h"
#include "protocol/bus_probe.h"
#include "protocol/codec.h"

namespace tumble {

bool hears_heartbeat(const BusAddress& bus, const std::string& world, double seconds) {
  using Clock = std::chrono::steady_clock;
  const std::string channel = channel_name(world, kHeartbeatSuffix), host = host_name();
  BusListener listener(bus);
  const auto start = Clock::now();
  double left = seconds;
  while (left > 0.0) {
    const auto datagram = listener.receive(left);
    left = seconds - std::chrono::duration<double>(Clock::now() - start).count();
    const auto message = datagram ? parse_short_message(datagram->bytes) : std::nullopt;
    if (!message || message->channel != channel) continue;
    heartbeat_t heartbeat{};
    const Bytes payload(reinterpret_cast<const std::uint8_t*>(message->payload.data()),
                        message->payload.size());
    if (decode(payload, heartbeat) == Malformed::none && heartbeat.host == host) return true;
  }
  return false;
}

}  // namespace tumble
