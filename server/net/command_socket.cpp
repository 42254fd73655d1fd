// See command_socket.h.
#include "net/command_socket.h"

#include <arpa/inet.h>
#include <linux/filter.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace tumble {
namespace {

constexpr std::uint32_t kUdpHeader = 8, kLcmHeader = 8, kFragmentHeader = 20;
constexpr std::size_t kMaxChannel = 63;
/// The longest datagram that is kept whole, and one byte more that tells the codec of a message that is too long.
constexpr std::size_t kSlot = kFragmentHeader + kMaxChannel + 1 + kMaxCommandBytes + 1;
constexpr int kBatch = 32;  // datagrams a system call
/// Room for 10 000 commands a second over a pause of 100 ms at the kernel's 1 kB for a small datagram.
constexpr int kReceiveBuffer = 1 << 20;

[[noreturn]] void fail(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

template <typename Value>
bool set_option(int socket, int level, int name, const Value& value) {
  return ::setsockopt(socket, level, name, &value, sizeof value) == 0;
}

void add(std::vector<sock_filter>& program, sock_filter instruction) {
  program.push_back(instruction);
}

/// Appends "if the load `load` at byte `at` of the LCM message is `value`, go on, else skip `skip` instructions".
void add_test(std::vector<sock_filter>& program, int load, std::size_t at, std::uint32_t value,
              std::size_t skip) {
  const auto code = static_cast<std::uint16_t>(BPF_LD | BPF_ABS | load);
  add(program, BPF_STMT(code, static_cast<std::uint32_t>(kUdpHeader + at)));
  add(program, BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, 0, static_cast<std::uint8_t>(skip)));
}

/// Classic packet filter over the UDP datagram. Kept, cut to kSlot bytes: short messages but for those on `ignored`,
/// and first fragments, which are only counted. A datagram that ends before a byte that is tested is dropped.
std::vector<sock_filter> make_filter(const std::string& ignored) {
  constexpr std::uint32_t kShort = 0x4c433032, kFragment = 0x4c433033;  // "LC02", "LC03"
  const std::size_t length = ignored.size() + 1;                        // with the closing zero
  std::vector<sock_filter> program;
  add_test(program, BPF_W, 0, kShort, 2 * length + 1);
  for (std::size_t i = 0; i < length; ++i) {
    const auto byte = static_cast<std::uint8_t>(ignored.c_str()[i]);
    add_test(program, BPF_B, kLcmHeader + i, byte, 2 * (length - 1 - i) + 1 + 4);
  }
  add(program, BPF_STMT(BPF_RET | BPF_K, 0));
  add_test(program, BPF_W, 0, kFragment, 3);
  add_test(program, BPF_H, 16, 0, 1);
  add(program, BPF_STMT(BPF_RET | BPF_K, static_cast<std::uint32_t>(kUdpHeader + kSlot)));
  add(program, BPF_STMT(BPF_RET | BPF_K, 0));
  return program;
}

void join(int socket, const BusAddress& address) {
  const int yes = 1;
  set_option(socket, SOL_SOCKET, SO_REUSEADDR, yes);
  set_option(socket, SOL_SOCKET, SO_REUSEPORT, yes);
  set_option(socket, SOL_SOCKET, SO_RXQ_OVFL, yes);
  set_option(socket, SOL_SOCKET, SO_RCVBUF, std::max(address.receive_buffer, kReceiveBuffer));
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_port = htons(address.port);
  inet_pton(AF_INET, address.group.c_str(), &group.sin_addr);
  // Bound to the group, not to any address: unicast datagrams to the port don't reach the server.
  if (::bind(socket, reinterpret_cast<const sockaddr*>(&group), sizeof group) != 0) fail("bind");
  ip_mreq membership{};
  membership.imr_multiaddr = group.sin_addr;
  membership.imr_interface.s_addr = htonl(INADDR_ANY);
  if (!set_option(socket, IPPROTO_IP, IP_ADD_MEMBERSHIP, membership)) fail("IP_ADD_MEMBERSHIP");
}

/// Room for the one thing that the kernel says beside a datagram.
union Control {
  char bytes[CMSG_SPACE(sizeof(std::uint32_t))];
  cmsghdr align;
};

/// The kernel's count of dropped datagrams, if it came with this one.
std::optional<std::uint32_t> read_dropped(msghdr& header) {
  for (cmsghdr* part = CMSG_FIRSTHDR(&header); part != nullptr; part = CMSG_NXTHDR(&header, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SO_RXQ_OVFL) continue;
    std::uint32_t count = 0;
    std::memcpy(&count, CMSG_DATA(part), sizeof count);
    return count;
  }
  return std::nullopt;
}

}  // namespace

std::optional<ShortMessage> parse_datagram(std::string_view bytes) {
  if (!bytes.starts_with("LC03")) return parse_short_message(bytes);
  if (bytes.size() < kFragmentHeader) return std::nullopt;
  bytes.remove_prefix(kFragmentHeader);
  const auto end = bytes.find('\0');
  if (end == std::string_view::npos) return std::nullopt;
  return ShortMessage{bytes.substr(0, end), bytes.substr(end + 1)};
}

CommandSocket::CommandSocket(const BusAddress& address, const std::string& ignored_channel)
    : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)), buffers_(kBatch * kSlot) {
  if (socket_ < 0) fail("socket");
  try {
    std::vector<sock_filter> program = make_filter(ignored_channel);
    const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
    if (!set_option(socket_, SOL_SOCKET, SO_ATTACH_FILTER, filter)) fail("SO_ATTACH_FILTER");
    join(socket_, address);
  } catch (...) {
    ::close(socket_);
    throw;
  }
}

CommandSocket::~CommandSocket() {
  ::close(socket_);
}

std::string CommandSocket::sender() const {
  std::array<char, INET_ADDRSTRLEN> address{};
  ::inet_ntop(AF_INET, &sender_.sin_addr, address.data(), address.size());
  return std::string(address.data()) + ":" + std::to_string(ntohs(sender_.sin_port));
}

int CommandSocket::receive(int budget, const Handler& handler) {
  std::array<mmsghdr, kBatch> headers;
  std::array<iovec, kBatch> slices;
  std::array<sockaddr_in, kBatch> senders;
  std::array<Control, kBatch> controls;
  int total = 0;
  while (total < budget) {
    const int wanted = std::min(kBatch, budget - total);
    for (std::size_t i = 0; i < static_cast<std::size_t>(wanted); ++i) {
      slices[i] = {buffers_.data() + i * kSlot, kSlot};
      headers[i] = {};
      headers[i].msg_hdr.msg_iov = &slices[i];
      headers[i].msg_hdr.msg_iovlen = 1;
      headers[i].msg_hdr.msg_name = &senders[i];
      headers[i].msg_hdr.msg_namelen = sizeof senders[i];
      headers[i].msg_hdr.msg_control = &controls[i];
      headers[i].msg_hdr.msg_controllen = sizeof controls[i];
    }
    const int count =
        ::recvmmsg(socket_, headers.data(), static_cast<unsigned>(wanted), MSG_DONTWAIT, nullptr);
    if (count <= 0) break;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      dropped_ = read_dropped(headers[i].msg_hdr).value_or(dropped_);
      sender_ = senders[i];
      const std::string_view bytes(reinterpret_cast<const char*>(slices[i].iov_base), headers[i].msg_len);
      if (const auto message = parse_datagram(bytes)) {
        handler(message->channel,
                {reinterpret_cast<const std::uint8_t*>(message->payload.data()), message->payload.size()});
      }
    }
    total += count;
    if (count < wanted) break;
  }
  return total;
}

}  // namespace tumble
