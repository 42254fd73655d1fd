// The LCM bus behind five functions. Sending goes through liblcm; receiving from multicast through our own socket
// (command_socket.h), from LCM's other providers (memq for tests, tcpq) through liblcm. liblcm is only called once a
// probe of our own has shown that it will neither block nor abort.
#pragma once

#include <lcm/lcm.h>

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "net/command_socket.h"
#include "protocol/bus_address.h"
#include "protocol/codec.h"

namespace tumble {

/// The bus can't be used; what() says why and names the command that repairs it, ready to be shown.
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Bus {
 public:
  using Handler = std::function<void(Bytes payload)>;

  /// Opens the bus for the server of `world`. Under 0.5 s. Throws BusError.
  Bus(const BusAddress& address, const std::string& world);
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  /// Sends one message; false if the system refused. Any thread.
  bool publish(const std::string& channel, Bytes payload);
  /// Calls `handler`, from receive(), for every message on exactly this channel. Handlers may publish, not subscribe.
  void subscribe(const std::string& channel, Handler handler);
  /// Handles the waiting messages, at most `budget`, without blocking; returns how many.
  int receive(int budget);

  /// Returns when a message waits or `ns` have passed, whichever is first.
  void wait(std::int64_t ns) const;

  /// Of the messages that waited to be received, those the system had no room for; 0 where it doesn't say.
  std::uint32_t dropped() const { return socket_ ? socket_->dropped() : 0; }
  /// Who sent the message that is being handled; empty where LCM doesn't say.
  std::string sender() const { return socket_ ? socket_->sender() : ""; }

  std::size_t payload_limit() const { return payload_limit_; }  ///< [bytes] for everything the server sends
  const BusAddress& address() const { return address_; }
  const std::string& interface() const { return interface_; }  ///< Of the multicast route; empty if unknown.

 private:
  struct Subscription {
    std::string channel;
    Handler handler;
  };
  static void handle(const lcm_recv_buf_t* buffer, const char* channel, void* subscription) noexcept;
  int receive_lcm(int budget);

  BusAddress address_;
  std::string interface_;
  std::size_t payload_limit_;
  lcm_t* lcm_ = nullptr;
  std::optional<CommandSocket> socket_;
  std::vector<std::unique_ptr<Subscription>> subscriptions_;
};

}  // namespace tumble
