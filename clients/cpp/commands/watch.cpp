// tumble watch [NAME...]: where bodies are, live. On a terminal a table drawn in place that fits it; into a pipe or
// file a line for every new state of a body.
#include <fmt/format.h>

#include <limits>

#include "commands/body_text.h"
#include "commands/command.h"
#include "commands/table.h"
#include "commands/terminal.h"

namespace tumble::client {
namespace {

/// A person reads no faster [s].
constexpr double kRedrawPeriod = 0.1;

std::vector<const Body*> chosen_bodies(const World& world, const std::vector<std::string>& names) {
  std::vector<const Body*> chosen;
  for (const std::string& name : names) {
    if (const Body* body = world.picture().find(name); body && body->placed) chosen.push_back(body);
  }
  if (names.empty()) {
    for (const auto& [id, body] : world.picture().bodies()) {
      if (body.placed && !body.is_static()) chosen.push_back(&body);
    }
  }
  return chosen;
}

std::string format_panel(const World& world, const std::vector<const Body*>& bodies, TerminalSize size) {
  Table table;
  table.add_column("NAME", Table::Align::left);
  table.add_column("MOTION", Table::Align::left);
  for (const char* title :
       {"X [m]", "Y", "Z", "VX [m/s]", "VY", "VZ", "WX [rad/s]", "WY", "WZ", "QW", "QX", "QY", "QZ"}) {
    table.add_column(title, Table::Align::right);
  }
  for (const Body* body : bodies) {
    std::vector<std::string> row{body->name, motion_text(*body)};
    for (const double value : body->position) row.push_back(fmt::format("{:9.4f}", value));
    for (const double value : body->velocity) row.push_back(fmt::format("{:8.3f}", value));
    for (const double value : body->angular_velocity) row.push_back(fmt::format("{:8.3f}", value));
    for (const double value : body->orientation) row.push_back(fmt::format("{:7.4f}", value));
    table.add_row(std::move(row));
  }
  const std::string title =
      fmt::format("{}  step {}  {:.3f} s  {} bodies   (Ctrl-C ends)", world.name(), world.picture().step(),
                  world.picture().time(), world.picture().num_bodies());
  // One line for the title, one for the cursor below.
  return cut(title, size.width) + "\n" + table.format(size.width, size.height > 3 ? size.height - 2 : 2);
}

void print_line(const Globals& globals, const Body& body) {
  if (globals.json) {
    fmt::print("{}\n", to_json(body).dump());
  } else {
    fmt::print("{} {:.6f} {} {} {} {}\n", body.step, body.time, body.name, fmt::join(body.position, " "),
               fmt::join(body.velocity, " "), motion_text(body));
  }
  std::fflush(stdout);
}

/// Draws until Ctrl-C or `count` tables.
void watch_on_terminal(World& world, const std::vector<std::string>& names, std::int64_t count) {
  Panel panel;
  for (std::int64_t drawn = 0; drawn < count && !Interrupt::pressed(); ++drawn) {
    if (drawn > 0) world.spin(kRedrawPeriod);
    panel.draw(format_panel(world, chosen_bodies(world, names), get_terminal_size()));
  }
}

/// Prints until Ctrl-C or `count` lines.
void watch_as_lines(const Globals& globals, World& world, const std::vector<std::string>& names,
                    std::int64_t count) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::pair<std::int64_t, std::int64_t>> printed;
  if (!globals.json) fmt::print("# step time[s] name x y z[m] vx vy vz[m/s] motion\n");
  for (std::int64_t lines = 0; lines < count && !Interrupt::pressed();) {
    for (const Body* body : chosen_bodies(world, names)) {
      const std::pair now{world.picture().session(), body->step};
      if (const auto [entry, is_new] = printed.try_emplace({body->id, body->generation}, now); !is_new) {
        if (entry->second == now) continue;
        entry->second = now;
      }
      print_line(globals, *body);
      if (++lines == count) break;
    }
    const std::int64_t step = world.picture().step();
    world.spin_until([&] { return world.picture().step() != step || Interrupt::pressed(); }, 1.0);
  }
}

int watch(const Globals& globals, const std::vector<std::string>& names, std::int64_t count) {
  World world(globals.world_options());
  for (const std::string& name : names) world.wait_for_body(name, globals.timeout);
  if (names.empty()) world.wait_for_picture(globals.timeout);
  const Interrupt interrupt;
  if (get_terminal_size().width > 0 && !globals.json) {
    watch_on_terminal(world, names, count);
  } else {
    watch_as_lines(globals, world, names, count);
  }
  return kDone;
}

}  // namespace

void add_watch(CLI::App& app, const Globals& globals, Action& action) {
  auto* command = app.add_subcommand("watch", "Watch bodies move; without a name all that can move");
  auto names = std::make_shared<std::vector<std::string>>();
  auto count = std::make_shared<std::int64_t>(std::numeric_limits<std::int64_t>::max());
  command->add_option("NAME", *names, "Names of the bodies");
  command->add_option("--count", *count, "End after so many tables (terminal) or lines (else)")
      ->check(CLI::PositiveNumber);
  command->callback([&globals, &action, names, count] {
    action = [&globals, names, count] { return watch(globals, *names, *count); };
  });
}

}  // namespace tumble::client
