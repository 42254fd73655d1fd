// Reader of LCM URLs, see bus_address.h.
#include "protocol/bus_address.h"

#include <arpa/inet.h>

#include <charconv>
#include <cstdlib>
#include <stdexcept>

namespace tumble {
namespace {

[[noreturn]] void refuse(const BusAddress& address, const std::string& reason) {
  throw std::invalid_argument("LCM URL \"" + address.url + "\": " + reason);
}

int read_number(const BusAddress& address, const char* field, std::string_view text, int low, int high) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < low || value > high) {
    refuse(address, std::string(field) + " must be a whole number from " + std::to_string(low) + " to " +
                        std::to_string(high) + ", not \"" + std::string(text) + "\"");
  }
  return value;
}

void read_group_and_port(BusAddress& address, std::string_view network) {
  const auto colon = network.find(':');
  address.group = network.substr(0, colon);
  address.port = 7667;
  if (address.group.empty()) address.group = "239.255.76.67";
  if (colon != std::string_view::npos) {
    address.port =
        static_cast<std::uint16_t>(read_number(address, "the port", network.substr(colon + 1), 1, 65535));
  }
  in_addr parsed{};
  if (inet_pton(AF_INET, address.group.c_str(), &parsed) != 1 || !IN_MULTICAST(ntohl(parsed.s_addr))) {
    refuse(address,
           "\"" + address.group + "\" is not an IPv4 multicast address (224.0.0.0 to 239.255.255.255)");
  }
}

void read_options(BusAddress& address, std::string_view options) {
  while (!options.empty()) {
    const auto end = options.find('&');
    const std::string_view option = options.substr(0, end);
    options = end == std::string_view::npos ? std::string_view() : options.substr(end + 1);
    const auto equals = option.find('=');
    const std::string_view key = option.substr(0, equals);
    const std::string_view value =
        equals == std::string_view::npos ? std::string_view() : option.substr(equals + 1);
    if (key == "ttl") {
      address.ttl = read_number(address, "ttl", value, 0, 255);
    } else if (key == "recv_buf_size") {
      address.receive_buffer = read_number(address, "recv_buf_size", value, 1, 1 << 30);
    } else if (key != "transmit_only") {
      refuse(address, "unknown option \"" + std::string(key) + "\" (known: ttl, recv_buf_size)");
    }
  }
}

}  // namespace

BusAddress parse_bus_url(std::string_view url) {
  BusAddress address;
  address.url = url;
  if (address.url.empty()) {
    const char* from_environment = std::getenv("LCM_DEFAULT_URL");
    address.url = from_environment && *from_environment ? from_environment : kDefaultBusUrl;
  }
  const std::string_view text = address.url;
  const auto colon = text.find("://");
  if (colon == std::string_view::npos || colon == 0) {
    refuse(address, "expected provider://network?options, such as " + std::string(kDefaultBusUrl));
  }
  address.provider = text.substr(0, colon);
  if (address.provider == "udpm") {
    const std::string_view rest = text.substr(colon + 3);
    const auto question = rest.find('?');
    read_group_and_port(address, rest.substr(0, question));
    if (question != std::string_view::npos) read_options(address, rest.substr(question + 1));
  } else if (address.provider != "memq" && address.provider != "tcpq" && address.provider != "file") {
    refuse(address, "unknown provider \"" + address.provider + "\" (known: udpm, memq, tcpq, file)");
  }
  return address;
}

}  // namespace tumble
