// Where the bus is: the LCM URL taken apart. LCM itself accepts a wrong URL with a line on stderr and a null pointer;
// servers and clients read it here first, so that the user gets one clear sentence.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace tumble {

inline constexpr const char* kDefaultBusUrl = "udpm://239.255.76.67:7667?ttl=0";

/// An LCM URL: provider://network?options. For udpm the group, port and time to live are known too.
struct BusAddress {
  std::string url;       ///< As LCM gets it.
  std::string provider;  ///< "udpm", "memq", "tcpq", "file", ...
  std::string group;     ///< udpm: dotted IPv4 multicast address.
  std::uint16_t port = 0;
  int ttl = 0;             ///< udpm: 0 keeps datagrams on this host.
  int receive_buffer = 0;  ///< udpm: recv_buf_size asked for [B]; 0: the kernel's default.

  bool is_multicast() const { return provider == "udpm"; }
};

/// Reads `url`; if empty the environment's LCM_DEFAULT_URL, and if that is empty too LCM's own default.
/// Throws std::invalid_argument naming the URL, the part of it and what is wrong.
BusAddress parse_bus_url(std::string_view url);

}  // namespace tumble
