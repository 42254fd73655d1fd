// The name of the machine or container, as in heartbeat_t.
#pragma once

#include <unistd.h>

#include <array>
#include <string>

namespace tumble {

inline std::string host_name() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  return name.data();
}

}  // namespace tumble
