// What the server says when it is up: its channels, and the lines to paste for every kind of client.
#pragma once

#include <string>

#include "net/bus.h"
#include "server.h"

namespace tumble {

std::string greeting(const ServerSettings& settings, const Bus& bus, const World& world);

}  // namespace tumble
