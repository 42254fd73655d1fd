// tumble doctor: does the network carry LCM here, who serves worlds on it, and which command repairs what is wrong.
// Plain sockets only: LCM itself blocks for 10 s on a broken network and aborts afterwards.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "commands/command.h"
#include "protocol/bus_probe.h"

namespace tumble::client {
namespace {

constexpr const char* kVirtual[] = {"docker", "br-", "veth", "virbr", "vmnet", "tun", "tap", "wg"};

/// Two heartbeats of every server fit in, so that a server that just ended is not counted as a second one [s].
constexpr double kListenTime = 1.3;
/// Holds a burst of the state of about a thousand bodies [B]; the kernel counts overhead, too.
constexpr int kGoodBuffer = 1 << 20;

enum class Verdict { good, warning, fault };

struct Finding {
  Verdict verdict;
  std::string topic, text;
  std::string repair;  ///< Command; empty if there is none.
};

struct Server {
  heartbeat_t last;
  std::string sender;
  int heard = 0;
};

struct Traffic {
  std::map<std::string, Server> servers;  ///< By world, host and process.
  std::int64_t datagrams = 0, bytes = 0;
};

Traffic listen(const BusAddress& bus, double seconds) {
  using Clock = std::chrono::steady_clock;
  Traffic traffic;
  BusListener listener(bus);
  const auto start = Clock::now();
  for (double left = seconds; left > 0;
       left = seconds - std::chrono::duration<double>(Clock::now() - start).count()) {
    const auto datagram = listener.receive(left);
    if (!datagram) continue;
    ++traffic.datagrams;
    traffic.bytes += static_cast<std::int64_t>(datagram->bytes.size());
    const auto message = parse_short_message(datagram->bytes);
    if (!message || !message->channel.ends_with(kHeartbeatSuffix)) continue;
    heartbeat_t heartbeat;
    const Bytes payload(reinterpret_cast<const std::uint8_t*>(message->payload.data()),
                        message->payload.size());
    if (decode(payload, heartbeat) != Malformed::none) continue;
    Server& server = traffic.servers[fmt::format("{} {} {}", heartbeat.world, heartbeat.host, heartbeat.pid)];
    server = {heartbeat, datagram->sender, server.heard + 1};
  }
  return traffic;
}

Finding check_network(const BusAddress& bus, const BusReport& report) {
  if (!report.works()) return {Verdict::fault, "network", report.what, report.repair};
  return {Verdict::good, "network",
          fmt::format("multicast to {}:{} over {}, own echo after {:.2f} ms", bus.group, bus.port,
                      report.interface.empty() ? "?" : report.interface, 1e3 * report.echo_seconds),
          ""};
}

bool in_container() {
  return std::filesystem::exists("/.dockerenv") || std::filesystem::exists("/run/.containerenv");
}

/// Interfaces that lead to containers, virtual machines or tunnels, by the names their makers give them.
bool is_virtual(const std::string& interface) {
  const auto starts = [&](const char* prefix) { return interface.starts_with(prefix); };
  return std::any_of(std::begin(kVirtual), std::end(kVirtual), starts);
}

Finding check_reach(const BusAddress& bus, const BusReport& report) {
  if (bus.ttl == 0 && in_container()) {
    return {Verdict::warning, "reach", "this container only: with ttl=0 in the URL nothing leaves it",
            fmt::format("export LCM_DEFAULT_URL='udpm://{}:{}?ttl=1'   # in every container of the network",
                        bus.group, bus.port)};
  }
  if (bus.ttl == 0) return {Verdict::good, "reach", "this host only (ttl=0 in the URL)", ""};
  if (is_virtual(report.interface)) {
    return {Verdict::warning, "reach",
            fmt::format("ttl={}, but the route leads to {}, which looks virtual", bus.ttl, report.interface),
            as_root("ip route replace 224.0.0.0/4 dev INTERFACE") + "   # one of: ip -br link"};
  }
  if (report.interface == "lo") {
    return {Verdict::warning, "reach", fmt::format("ttl={}, but the route stays on this host (lo)", bus.ttl),
            as_root("ip route del 224.0.0.0/4 dev lo") + "   # then the default route carries multicast"};
  }
  return {Verdict::good, "reach",
          fmt::format("the local network (ttl={}) over {}", bus.ttl, report.interface), ""};
}

Finding check_buffer(const BusReport& report) {
  if (report.receive_buffer >= kGoodBuffer) {
    return {Verdict::good, "buffer",
            fmt::format("{} kB receive buffer by default", report.receive_buffer / 1024), ""};
  }
  return {Verdict::warning, "buffer",
          fmt::format("{} kB receive buffer by default: lcm-spy and lcm-logger lose messages of large worlds",
                      report.receive_buffer / 1024),
          as_root("sysctl -w net.core.rmem_max=4194304 net.core.rmem_default=4194304")};
}

Finding describe_server(const Server& server) {
  const heartbeat_t& last = server.last;
  const std::string text =
      fmt::format("{}: {} bodies, {}, step {}{}; process {} on {} ({})", last.world, last.num_bodies,
                  last.scene, last.step, last.paused ? ", paused" : "", last.pid, last.host, server.sender);
  if (last.protocol_version == kProtocolVersion) return {Verdict::good, "server", text, ""};
  return {Verdict::fault, "server",
          fmt::format("{}; it speaks protocol version {}, this client {}", text, last.protocol_version,
                      kProtocolVersion),
          ""};
}

bool is_served(const std::string& world, const Traffic& traffic) {
  return std::any_of(traffic.servers.begin(), traffic.servers.end(),
                     [&](const auto& entry) { return entry.second.last.world == world; });
}

/// By a server that understands this client's questions.
bool is_understood(const std::string& world, const Traffic& traffic) {
  return std::any_of(traffic.servers.begin(), traffic.servers.end(), [&](const auto& entry) {
    const heartbeat_t& last = entry.second.last;
    return last.world == world && last.protocol_version == kProtocolVersion;
  });
}

void check_servers(const Globals& globals, const Traffic& traffic, std::vector<Finding>& findings) {
  std::map<std::string, std::vector<const Server*>> by_world;
  for (const auto& [key, server] : traffic.servers) {
    findings.push_back(describe_server(server));
    if (server.heard >= 2) by_world[server.last.world].push_back(&server);
  }
  for (const auto& [world, servers] : by_world) {
    if (servers.size() < 2) continue;
    const heartbeat_t& later = servers.back()->last;
    findings.push_back(
        {Verdict::fault, "server",
         fmt::format("{} servers share the name {}: every client sees a mixture", servers.size(), world),
         fmt::format("kill {}   # on {}; or start it with --world {}_2", later.pid, later.host, world)});
  }
  if (!is_served(globals.world, traffic)) {
    const std::string other = traffic.servers.empty() ? "" : " (but the above)";
    findings.push_back({Verdict::fault, "server",
                        fmt::format("no server for world {}{}", globals.world, other),
                        globals.world == kDefaultWorld
                            ? "tumble-server --demo pile"
                            : fmt::format("tumble-server --demo pile --world {}", globals.world)});
  }
}

/// Does what is sent reach the server, and its answer come back? Hearing it shows one direction only.
Finding check_answer(const Globals& globals) {
  World world(globals.world_options());
  query_t query{};
  query.kind = query_t::KIND_BOX;
  query.ignored = -1;
  const auto start = std::chrono::steady_clock::now();
  try {
    world.ask(query);
  } catch (const NoServer&) {
    return {
        Verdict::fault, "answer",
        fmt::format("the server of {} is heard, but answers nothing: commands don't reach it", globals.world),
        "tumble doctor   # on the server's machine: a firewall there, or a route that leads elsewhere"};
  }
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  return {Verdict::good, "answer", fmt::format("a question was answered after {:.1f} ms", took.count()), ""};
}

void print_findings(const std::vector<Finding>& findings) {
  constexpr const char* marks[] = {"ok     ", "warning", "FAULT  "};
  for (const Finding& finding : findings) {
    fmt::print("{}  {:8} {}\n", marks[static_cast<int>(finding.verdict)], finding.topic, finding.text);
    if (!finding.repair.empty()) fmt::print("         repair:  {}\n", finding.repair);
  }
}

void print_json(const std::vector<Finding>& findings) {
  constexpr const char* verdicts[] = {"ok", "warning", "fault"};
  auto array = nlohmann::ordered_json::array();
  for (const Finding& finding : findings) {
    array.push_back({{"verdict", verdicts[static_cast<int>(finding.verdict)]},
                     {"topic", finding.topic},
                     {"text", finding.text},
                     {"repair", finding.repair}});
  }
  fmt::print("{}\n", array.dump(2));
}

int examine(const Globals& globals, bool network_only) {
  const BusAddress bus = parse_bus_url(globals.url);
  std::vector<Finding> findings{{Verdict::good, "url", bus.url, ""}};
  if (!bus.is_multicast()) {
    findings.push_back({Verdict::warning, "network", "nothing to examine: the URL is not udpm", ""});
  } else {
    const BusReport report = probe_bus(bus);
    findings.push_back(check_network(bus, report));
    if (report.works()) {
      findings.push_back(check_reach(bus, report));
      findings.push_back(check_buffer(report));
      if (!network_only) {
        const Traffic traffic = listen(bus, kListenTime);
        findings.push_back({Verdict::good, "traffic",
                            fmt::format("{:.0f} datagrams/s, {:.1f} kB/s",
                                        static_cast<double>(traffic.datagrams) / kListenTime,
                                        static_cast<double>(traffic.bytes) / kListenTime / 1e3),
                            ""});
        check_servers(globals, traffic, findings);
        if (is_understood(globals.world, traffic)) findings.push_back(check_answer(globals));
      }
    }
  }
  globals.json ? print_json(findings) : print_findings(findings);
  const bool faulty = std::any_of(findings.begin(), findings.end(),
                                  [](const Finding& finding) { return finding.verdict == Verdict::fault; });
  return faulty ? kRefused : kDone;
}

}  // namespace

void add_doctor(CLI::App& app, const Globals& globals, Action& action) {
  auto* command =
      app.add_subcommand("doctor", "Examine the network and the servers on it; name the repairing command");
  auto network_only = std::make_shared<bool>(false);
  command->add_flag("--network-only", *network_only, "Don't listen for servers");
  command->callback([&globals, &action, network_only] {
    action = [&globals, network_only] { return examine(globals, *network_only); };
  });
}

}  // namespace tumble::client
