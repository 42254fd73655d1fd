// Multicast probe and listener on plain sockets, see bus_probe.h. The probe's datagram is a message on LCM's own
// self-test channel, so that it adds no channel to anybody's list.
#include "protocol/bus_probe.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>

namespace tumble {
namespace {

using Clock = std::chrono::steady_clock;

/// Owns a descriptor.
class Socket {
 public:
  Socket() : descriptor_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), "socket");
  }
  ~Socket() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  int get() const { return descriptor_; }
  int release() { return std::exchange(descriptor_, -1); }

 private:
  int descriptor_;
};

sockaddr_in make_address(const std::string& host, std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  inet_pton(AF_INET, host.c_str(), &address.sin_addr);
  return address;
}

const sockaddr* generic(const sockaddr_in& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

/// Binds to the group's port, shared, and joins the group. 0 or errno; `joined` tells which of the two failed.
int open_receiver(int socket, const BusAddress& bus, bool& bound) {
  const int yes = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEPORT, &yes, sizeof yes);
  if (bus.receive_buffer > 0) {
    ::setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &bus.receive_buffer, sizeof bus.receive_buffer);
  }
  const sockaddr_in group = make_address(bus.group, bus.port);
  bound = ::bind(socket, generic(group), sizeof group) == 0;
  if (!bound) return errno;
  ip_mreq membership{};
  membership.imr_multiaddr = group.sin_addr;
  membership.imr_interface.s_addr = htonl(INADDR_ANY);
  if (::setsockopt(socket, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) != 0) return errno;
  return 0;
}

int get_receive_buffer(int socket) {
  int size = 0;
  socklen_t length = sizeof size;
  ::getsockopt(socket, SOL_SOCKET, SO_RCVBUF, &size, &length);
  return size;
}

/// The interface of the most specific route to `group`, read from the kernel's table: a socket's own address doesn't
/// tell, since multicast over loopback leaves it unset.
std::string find_interface(in_addr group) {
  std::ifstream table("/proc/net/route");
  std::string line, best;
  std::uint32_t best_mask = 0;
  std::getline(table, line);  // column titles
  while (std::getline(table, line)) {
    std::istringstream columns(line);
    std::string name, gateway;
    std::uint32_t destination = 0, flags = 0, count = 0, uses = 0, metric = 0, mask = 0;
    columns >> name >> std::hex >> destination >> gateway >> flags >> count >> uses >> metric >> mask;
    if (!columns || (group.s_addr & mask) != destination) continue;
    if (best.empty() || ntohl(mask) > best_mask) {
      best = name;
      best_mask = ntohl(mask);
    }
  }
  return best;
}

bool loopback_is_up() {
  bool up = false;
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return true;
  for (const ifaddrs* entry = list; entry; entry = entry->ifa_next) {
    if ((entry->ifa_flags & IFF_LOOPBACK) && (entry->ifa_flags & IFF_UP)) up = true;
  }
  ::freeifaddrs(list);
  return up;
}

std::string route_repair() {
  const std::string up = loopback_is_up() ? "" : as_root("ip link set lo up") + " && ";
  return up + as_root("ip route replace 224.0.0.0/4 dev lo src 127.0.0.1");
}

/// What a connected socket sends over the loopback from another interface's address, kernels may drop as forged.
bool has_foreign_source(int socket, const std::string& interface) {
  constexpr std::uint32_t kLoopbackNetwork = 127;
  sockaddr_in own{};
  socklen_t length = sizeof own;
  if (interface != "lo" || ::getsockname(socket, reinterpret_cast<sockaddr*>(&own), &length) != 0)
    return false;
  return ntohl(own.sin_addr.s_addr) >> 24 != kLoopbackNetwork && own.sin_addr.s_addr != INADDR_ANY;
}

std::string firewall_repair(const std::string& chain, const BusAddress& bus) {
  return as_root("iptables -I " + chain + " -d " + bus.group + " -p udp --dport " + std::to_string(bus.port) +
                 " -j ACCEPT");
}

void report(BusReport& report, BusFault fault, std::string what, std::string repair) {
  report.fault = fault;
  report.what = std::move(what);
  report.repair = std::move(repair);
}

std::string name_group(const BusAddress& bus) {
  return bus.group + ":" + std::to_string(bus.port);
}

/// "LC02", a sequence number, the channel of LCM's own self test, and 16 random bytes to know the echo by.
std::string make_probe_datagram() {
  std::string bytes("LC02\0\0\0\0LCM_SELF_TEST\0", 22);
  std::random_device random;
  for (int word = 0; word < 4; ++word) {
    const std::uint32_t bits = random();
    bytes.append(reinterpret_cast<const char*>(&bits), sizeof bits);
  }
  return bytes;
}

bool wait_for(int socket, double seconds) {
  pollfd waiting{socket, POLLIN, 0};
  return ::poll(&waiting, 1, seconds <= 0 ? 0 : static_cast<int>(seconds * 1000) + 1) > 0;
}

/// True when a datagram equal to `sent` arrived within `timeout` seconds.
bool wait_for_echo(int socket, const std::string& sent, double timeout) {
  const auto start = Clock::now();
  std::array<char, 65536> buffer;
  for (double left = timeout; left > 0;
       left = timeout - std::chrono::duration<double>(Clock::now() - start).count()) {
    if (!wait_for(socket, left)) return false;
    const ssize_t size = ::recv(socket, buffer.data(), buffer.size(), MSG_DONTWAIT);
    if (size > 0 && std::string_view(buffer.data(), static_cast<std::size_t>(size)) == sent) return true;
  }
  return false;
}

/// Sends one datagram to the group and waits for it.
void probe_echo(const BusAddress& bus, const Socket& sender, const Socket& receiver, double timeout,
                BusReport& result) {
  const std::string datagram = make_probe_datagram();
  const auto start = Clock::now();
  if (::send(sender.get(), datagram.data(), datagram.size(), 0) < 0) {
    const int error = errno;
    report(result, BusFault::send_blocked,
           "sending to " + name_group(bus) + " was refused: " + std::strerror(error) +
               " (a firewall rule on output?)",
           firewall_repair("OUTPUT", bus));
  } else if (wait_for_echo(receiver.get(), datagram, timeout)) {
    result.echo_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  } else if (has_foreign_source(sender.get(), result.interface)) {
    report(result, BusFault::no_echo,
           "a datagram sent to " + name_group(bus) +
               " over lo did not come back: the route gives it another interface's address as its source",
           route_repair());
  } else {
    report(result, BusFault::no_echo,
           "a datagram sent to " + name_group(bus) + " over " + result.interface +
               " did not come back (a firewall rule on input?)",
           firewall_repair("INPUT", bus));
  }
}

}  // namespace

BusReport probe_bus(const BusAddress& bus, double timeout) {
  BusReport result;
  if (!bus.is_multicast()) return result;
  const Socket receiver, sender;
  const sockaddr_in group = make_address(bus.group, bus.port);
  if (::connect(sender.get(), generic(group), sizeof group) != 0) {
    const int error = errno;
    report(result, BusFault::no_route,
           "no route for multicast to " + name_group(bus) + ": " + std::strerror(error), route_repair());
    return result;
  }
  result.interface = find_interface(group.sin_addr);
  const unsigned char ttl = static_cast<unsigned char>(bus.ttl), loop = 1;
  ::setsockopt(sender.get(), IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof ttl);
  ::setsockopt(sender.get(), IPPROTO_IP, IP_MULTICAST_LOOP, &loop, sizeof loop);

  bool bound = false;
  if (const int error = open_receiver(receiver.get(), bus, bound); error != 0) {
    if (!bound) {
      report(result, BusFault::port_taken,
             "UDP port " + std::to_string(bus.port) + " can't be opened: " + std::strerror(error),
             "ss -ulpn 'sport = :" + std::to_string(bus.port) +
                 "'   # shows who holds it; or choose another port");
    } else {
      report(result, BusFault::cannot_join, "can't join " + name_group(bus) + ": " + std::strerror(error),
             route_repair());
    }
    return result;
  }
  result.receive_buffer = get_receive_buffer(receiver.get());
  probe_echo(bus, sender, receiver, timeout, result);
  return result;
}

BusListener::BusListener(const BusAddress& bus) {
  Socket socket;
  bool bound = false;
  if (const int error = open_receiver(socket.get(), bus, bound); error != 0) {
    throw std::system_error(error, std::generic_category(), "listening on " + name_group(bus));
  }
  socket_ = socket.release();
}

BusListener::~BusListener() {
  ::close(socket_);
}

std::optional<BusListener::Datagram> BusListener::receive(double timeout) {
  if (!wait_for(socket_, timeout)) return std::nullopt;
  std::array<char, 65536> buffer;
  sockaddr_in sender{};
  socklen_t length = sizeof sender;
  const ssize_t size = ::recvfrom(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT,
                                  reinterpret_cast<sockaddr*>(&sender), &length);
  if (size < 0) return std::nullopt;
  std::array<char, INET_ADDRSTRLEN> text{};
  inet_ntop(AF_INET, &sender.sin_addr, text.data(), text.size());
  return Datagram{std::string(buffer.data(), static_cast<std::size_t>(size)),
                  std::string(text.data()) + ":" + std::to_string(ntohs(sender.sin_port))};
}

int BusListener::receive_buffer() const {
  return get_receive_buffer(socket_);
}

std::string as_root(const std::string& command) {
  return ::geteuid() == 0 ? command : "sudo " + command;
}

std::optional<ShortMessage> parse_short_message(std::string_view bytes) {
  constexpr std::size_t kHeader = 8;
  if (bytes.size() < kHeader || bytes.substr(0, 4) != "LC02") return std::nullopt;
  bytes.remove_prefix(kHeader);
  const auto end = bytes.find('\0');
  if (end == std::string_view::npos || end == 0 || end > 63) return std::nullopt;
  return ShortMessage{bytes.substr(0, end), bytes.substr(end + 1)};
}

}  // namespace tumble
