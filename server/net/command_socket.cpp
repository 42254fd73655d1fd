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

#include "protocol/bus_probe.h"

namespace tumble {
namespace {

constexpr std::uint32_t kUdpHeader = 8, kLcmHeader = 8;
constexpr std::size_t kMaxChannel = 63;
constexpr std::size_t kMaxDatagram = kLcmHeader + kMaxChannel + 1 + kMaxCommandBytes;
constexpr std::size_t kSlot = kMaxDatagram + 1;  // the byte too many tells the codec that it is too long
constexpr int kBatch = 32;  // datagrams a system call
/// Room for 10 000 commands a second over a pause of 100 ms at the kernel's 1 kB for a small datagram.
constexpr int kReceiveBuffer = 1 << 20;

[[noreturn]] void fail(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

template <typename Value>
bool set_option(int socket, int level, int name, const Value& value) {
  return ::setsockopt(socket, level, name, &value, sizeof value) == 0;
}

/// Classic packet filter over the UDP datagram: not LCM's short form -> drop; channel equal to `ignored` -> drop; else
/// keep, cut to one byte more than a command may have. A datagram shorter than the compared name is dropped by the
/// first load beyond its end; no command is that short.
std::vector<sock_filter> make_filter(const std::string& ignored) {
  constexpr std::uint32_t kShortForm = 0x4c433032;  // "LC02"
  const std::size_t length = ignored.size() + 1;    // with the closing zero
  const auto to_drop = static_cast<std::uint8_t>(2 * length);
  std::vector<sock_filter> program = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kUdpHeader),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kShortForm, 0, to_drop),
  };
  for (std::size_t i = 0; i < length; ++i) {
    const auto at = static_cast<std::uint32_t>(kUdpHeader + kLcmHeader + i);
    const auto to_keep = static_cast<std::uint8_t>(2 * (length - 1 - i) + 1);
    program.push_back(BPF_STMT(BPF_LD | BPF_B | BPF_ABS, at));
    program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint8_t>(ignored.c_str()[i]), 0, to_keep));
  }
  program.push_back(BPF_STMT(BPF_RET | BPF_K, 0));
  program.push_back(BPF_STMT(BPF_RET | BPF_K, static_cast<std::uint32_t>(kUdpHeader + kSlot)));
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

}  // namespace

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

CommandSocket::~CommandSocket() { ::close(socket_); }

int CommandSocket::receive(int budget, const Handler& handler) {
  std::array<mmsghdr, kBatch> headers;
  std::array<iovec, kBatch> slices;
  std::array<std::array<std::uint8_t, CMSG_SPACE(sizeof(std::uint32_t))>, kBatch> controls;
  int total = 0;
  while (total < budget) {
    const int wanted = std::min(kBatch, budget - total);
    for (std::size_t i = 0; i < static_cast<std::size_t>(wanted); ++i) {
      slices[i] = {buffers_.data() + i * kSlot, kSlot};
      headers[i] = {};
      headers[i].msg_hdr.msg_iov = &slices[i];
      headers[i].msg_hdr.msg_iovlen = 1;
      headers[i].msg_hdr.msg_control = controls[i].data();
      headers[i].msg_hdr.msg_controllen = controls[i].size();
    }
    const int count = ::recvmmsg(socket_, headers.data(), static_cast<unsigned>(wanted), MSG_DONTWAIT, nullptr);
    if (count <= 0) break;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      msghdr& header = headers[i].msg_hdr;
      for (cmsghdr* note = CMSG_FIRSTHDR(&header); note != nullptr; note = CMSG_NXTHDR(&header, note)) {
        if (note->cmsg_level != SOL_SOCKET || note->cmsg_type != SO_RXQ_OVFL) continue;
        std::uint32_t drops = 0;  // since the socket was opened
        std::memcpy(&drops, CMSG_DATA(note), sizeof drops);
        kernel_drops_ = drops;
      }
      const std::string_view bytes(reinterpret_cast<const char*>(slices[i].iov_base), headers[i].msg_len);
      if (const auto message = parse_short_message(bytes)) {
        handler(message->channel, {reinterpret_cast<const std::uint8_t*>(message->payload.data()),
                                   message->payload.size()});
      }
    }
    total += count;
    if (count < wanted) break;
  }
  return total;
}

}  // namespace tumble
