// tumble list: every body of the world with its shape, mass and place.
#include <fmt/format.h>

#include "commands/body_text.h"
#include "commands/command.h"
#include "commands/table.h"
#include "commands/terminal.h"

namespace tumble::client {
namespace {

void print_table(const World& world) {
  Table table;
  table.add_column("ID", Table::Align::right);
  table.add_column("NAME", Table::Align::left);
  table.add_column("MOTION", Table::Align::left);
  table.add_column("SHAPE [m]", Table::Align::left);
  for (const char* title : {"MASS [kg]", "X [m]", "Y [m]", "Z [m]"})
    table.add_column(title, Table::Align::right);
  for (const auto& [id, body] : world.picture().bodies()) {
    table.add_row({std::to_string(id), body.name, motion_text(body), shape_text(body),
                   body.mass > 0 ? fmt::format("{:.4g}", body.mass) : "-",
                   fmt::format("{:.3f}", body.position[0]), fmt::format("{:.3f}", body.position[1]),
                   fmt::format("{:.3f}", body.position[2])});
  }
  fmt::print("{}", table.format(get_terminal_size().width));
  const heartbeat_t& server = *world.heartbeat();
  fmt::print("{} bodies in {} ({}), step {}, {:.3f} s{}\n", table.rows(), world.name(), server.scene,
             world.picture().step(), world.picture().time(), server.paused ? ", paused" : "");
}

int list(const Globals& globals) {
  World world(globals.world_options());
  world.wait_for_picture(globals.timeout);
  if (!globals.json) {
    print_table(world);
    return kDone;
  }
  std::vector<std::string> bodies;  // one a line
  for (const auto& [id, body] : world.picture().bodies()) bodies.push_back(to_json(body).dump());
  fmt::print("[\n{}\n]\n", fmt::join(bodies, ",\n"));
  return kDone;
}

}  // namespace

void add_list(CLI::App& app, const Globals& globals, Action& action) {
  auto* command = app.add_subcommand("list", "List the bodies of the world");
  command->callback([&] { action = [&] { return list(globals); }; });
}

}  // namespace tumble::client
