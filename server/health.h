// Is the server of a world alive? Asked from outside its process: for containers' health checks and for scripts.
#pragma once

#include <string>

#include "protocol/bus_address.h"

namespace tumble {

/// True once a heartbeat of `world` from this machine (or container) was heard; false after `seconds` without one.
/// Throws std::system_error if the bus can't be listened to.
bool hears_heartbeat(const BusAddress& bus, const std::string& world, double seconds);

}  // namespace tumble
