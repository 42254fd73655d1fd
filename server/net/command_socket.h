// Commands from the multicast group, read by ourselves instead of by liblcm: its reassembly of fragmented messages can
// be crashed by two crafted datagrams, and it costs seven times more per message. Only LCM's short form (one datagram
// a message) can be a command; of a fragmented message the first fragment is handed on, so that it is counted as too
// long. The kernel drops the rest before it takes up buffer.
#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/bus_address.h"
#include "protocol/bus_probe.h"
#include "protocol/codec.h"

namespace tumble {

/// Channel and payload, or as much as was kept of it, of a short message or a first fragment; views into `bytes`.
std::optional<ShortMessage> parse_datagram(std::string_view bytes);

class CommandSocket {
 public:
  using Handler = std::function<void(std::string_view channel, Bytes payload)>;

  /// Joins the group of `address`. Messages on `ignored_channel` (the server's own state, looped back) are dropped by
  /// the kernel, long ones are cut to a little more than `kMaxCommandBytes`. Throws std::system_error.
  CommandSocket(const BusAddress& address, const std::string& ignored_channel);
  ~CommandSocket();
  CommandSocket(const CommandSocket&) = delete;
  CommandSocket& operator=(const CommandSocket&) = delete;

  /// Hands every waiting message, at most `budget` datagrams, to `handler`; returns how many datagrams were read.
  int receive(int budget, const Handler& handler);
  int fd() const { return socket_; }
  /// Datagrams that the kernel dropped since the start because the buffer was full.
  std::uint32_t dropped() const { return dropped_; }
  /// "address:port" of the sender of the message that is being handled, or was last.
  std::string sender() const;

 private:
  int socket_ = -1;
  std::vector<std::uint8_t> buffers_;
  sockaddr_in sender_{};
  std::uint32_t dropped_ = 0;
};

}  // namespace tumble
