// See greeting.h.
#include "greeting.h"

#include <fmt/format.h>

#include "protocol/bus_address.h"
#include "version.h"

namespace tumble {
namespace {

/// A dynamic body to take as the example; any name if there is none.
std::string example_body(const World& world) {
  for (std::uint32_t slot = 0; slot < world.body_capacity(); ++slot) {
    if (world.body(slot).exists && world.body(slot).type == BodyType::dynamic) {
      return world.body(slot).definition.name;
    }
  }
  return "ball";
}

}  // namespace

std::string greeting(const ServerSettings& settings, const Bus& bus, const World& world) {
  const std::string& name = settings.world_name;
  const std::string& url = bus.address().url;
  const std::string body = example_body(world);
  const bool default_world = name == kDefaultWorld, default_url = url == kDefaultBusUrl;
  const std::string options = (default_world ? "" : fmt::format(" --world {}", name)) +
                              (default_url ? "" : fmt::format(" --lcm-url '{}'", url));
  const std::string spy = default_url ? "" : fmt::format(" --lcm-url '{}'", url);
  const std::string python = (default_world ? "" : fmt::format("'{}'", name)) +
                             (default_url ? "" : fmt::format("{}url='{}'", default_world ? "" : ", ", url));
  const double dt = world.options().time_step;
  const std::string pace =
      settings.rate > 0.0 ? fmt::format("{:g} steps/s ({:g} x real time)", settings.rate, settings.rate * dt)
                          : "as fast as possible";
  return fmt::format(
      "tumble-server {version}: {scene}, {bodies} bodies, step {dt:g} s, {pace}\n"
      "bus {url}{interface}, state at {publish:g} Hz, messages up to {limit} bytes\n"
      "\n"
      "  sends     {w}_{state}  {w}_STATS  {w}_CATALOG  {w}_HEARTBEAT  {w}_ACK  {w}_HITS\n"
      "            {w}_BODY_<id> (watched bodies)  {w}_CONTACTS  {w}_PUSHES (on request)\n"
      "  receives  {w}_FORCE  {w}_CONTROL  {w}_QUERY\n"
      "\n"
      "In another terminal:\n"
      "  ./run spy{spy}\n"
      "  ./run tumble{options} list\n"
      "  ./run tumble{options} push {body} --force 0 0 50 --seconds 0.5\n"
      "  ./run python -c \"from tumble import World; World({python})['{body}'].push(force=(0, 0, 50), "
      "seconds=0.5)\"\n"
      "Ctrl-C stops the server.",
      fmt::arg("version", kVersion), fmt::arg("scene", settings.scene_name),
      fmt::arg("bodies", world.body_count()), fmt::arg("dt", dt), fmt::arg("pace", pace),
      fmt::arg("url", url),
      fmt::arg("interface", bus.interface().empty() ? "" : " on interface " + bus.interface()),
      fmt::arg("publish", settings.publish_rate), fmt::arg("limit", bus.payload_limit()), fmt::arg("w", name),
      fmt::arg("state", settings.packed ? "PACKED" : "STATE"), fmt::arg("spy", spy),
      fmt::arg("options", options), fmt::arg("body", body), fmt::arg("python", python));
}

}  // namespace tumble
