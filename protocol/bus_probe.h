// Does multicast work here? Answered with plain sockets in well under a second, before LCM is asked: LCM's own self
// test blocks for 10 s when a firewall eats the echo, and its handle() aborts the process afterwards.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "protocol/bus_address.h"

namespace tumble {

enum class BusFault {
  none,
  no_route,      ///< The kernel has no route for the group.
  port_taken,    ///< Another program holds the port alone.
  cannot_join,   ///< The group can't be joined on any interface.
  send_blocked,  ///< The datagram was refused on its way out (firewall).
  no_echo,       ///< Sent, but it never came back (firewall, or an interface without multicast).
};

struct BusReport {
  BusFault fault = BusFault::none;
  std::string what;       ///< One sentence for the user; empty if all is well.
  std::string repair;     ///< The exact command that repairs it; empty if all is well.
  std::string interface;  ///< Interface the route leads to, e.g. "lo"; empty if unknown.
  double echo_seconds = 0.0;
  int receive_buffer = 0;  ///< What a socket of LCM would get [B of payload and overhead].

  bool works() const { return fault == BusFault::none; }
};

/// Joins the group, sends one datagram to it and waits for it to come back, `timeout` seconds at most. Other providers
/// than udpm have nothing to probe and always work.
BusReport probe_bus(const BusAddress& address, double timeout = 0.3);

/// A socket that hears every datagram of the group, with the sender's address, which LCM hides. Throws
/// std::system_error if it can't be opened. Not copyable; closes itself.
class BusListener {
 public:
  struct Datagram {
    std::string bytes;
    std::string sender;  ///< "address:port"
  };

  explicit BusListener(const BusAddress& address);
  ~BusListener();
  BusListener(const BusListener&) = delete;
  BusListener& operator=(const BusListener&) = delete;

  /// The next datagram, or nothing within `timeout` seconds.
  std::optional<Datagram> receive(double timeout);
  int receive_buffer() const;  ///< [B], as the kernel counts it.

 private:
  int socket_ = -1;
};

/// The command as it must be typed: with sudo in front unless this process is root.
std::string as_root(const std::string& command);

/// A datagram of LCM's short form ("LC02"): channel and payload, both views into `bytes`. Nothing if it is not one.
struct ShortMessage {
  std::string_view channel, payload;
};
std::optional<ShortMessage> parse_short_message(std::string_view bytes);

}  // namespace tumble
