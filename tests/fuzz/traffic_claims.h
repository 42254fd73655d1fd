// What must hold of a server that any traffic reaches, between any ticks. Any bytes are traffic: records of a kind, a
// length in two bytes and as many bytes of content (or as many as are left).
//   kind % 5   0  a datagram as it comes from the wire
//              1  the rest of a force_command_t after its fingerprint     2  the same of a control_t
//              3  the rest of a message of type kind / 5, which a client would decode
//              4  a tick: what is due acts, the world makes a step, the answers go out
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tumble::test {

struct TrafficVerdict {
  std::string broken;            ///< The claim that does not hold, with values; empty: all hold.
  int decoded = 0, applied = 0;  ///< Messages that were sound; commands that took effect.
};

TrafficVerdict check_traffic(std::span<const std::uint8_t> input);

/// Traffic in which every message is sound and most commands apply: where mutations start from.
std::vector<std::uint8_t> sound_traffic();

}  // namespace tumble::test
