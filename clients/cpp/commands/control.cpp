// tumble pause, resume, step, reset, contacts and plot: the world as a whole, and what it streams.
#include <fmt/format.h>

#include "commands/command.h"
#include "commands/terminal.h"

namespace tumble::client {
namespace {

using Verb = Answer (World::*)();

void add_plain(CLI::App& app, const Globals& globals, Action& action, const char* name, const char* help,
               Verb verb) {
  auto* command = app.add_subcommand(name, help);
  command->callback([&globals, &action, name, verb] {
    action = [&globals, name, verb] {
      World world(globals.world_options());
      return print_answer(globals, name, (world.*verb)());
    };
  });
}

/// Returns when the steps are done, so that scripts can go on with the new state. Tells people how far it is.
int step(const Globals& globals, std::int64_t count) {
  World world(globals.world_options());
  const bool draws = get_terminal_size().width > 0;
  bool drawn = false;
  const Answer answer = world.advance(count, [&](std::int64_t done) {
    if (draws)
      fmt::print(stderr, "\r{} of {} steps ({:.0f} %)\033[K", done, count,
                 100.0 * static_cast<double>(done) / static_cast<double>(count));
    drawn = draws;
  });
  if (drawn) fmt::print(stderr, "\r\033[K");
  if (!answer.accepted() || globals.json) return print_answer(globals, "step", answer);
  fmt::print("step: now at step {}, {:.6f} s\n", world.picture().step(), world.picture().time());
  return kDone;
}

void add_step(CLI::App& app, const Globals& globals, Action& action) {
  auto count = std::make_shared<std::int64_t>(1);
  auto* command = app.add_subcommand("step", "Run some steps at full speed, then pause");
  command->add_option("N", *count, "How many; default 1")->check(CLI::Range(std::int64_t{1}, kMaxStepCount));
  command->callback(
      [&globals, &action, count] { action = [&globals, count] { return step(globals, *count); }; });
}

/// A switch argument.
CLI::Option* add_switch(CLI::App& command, bool& on) {
  return add_choice<bool>(command, "SWITCH", on, {{"on", true}, {"off", false}}, "Default on");
}

/// snapshot and restore.
void add_named(CLI::App& app, const Globals& globals, Action& action, const char* verb, const char* help,
               Answer (World::*act)(const std::string&)) {
  auto name = std::make_shared<std::string>();
  auto* command = app.add_subcommand(verb, help);
  command->add_option("NAME", *name, "Name of the snapshot")->required();
  command->callback([&globals, &action, name, act] {
    action = [&globals, name, act] {
      World world(globals.world_options());
      return print_answer(globals, *name, (world.*act)(*name));
    };
  });
}

void add_streams(CLI::App& app, const Globals& globals, Action& action) {
  auto contacts_on = std::make_shared<bool>(true);
  auto* command = app.add_subcommand("contacts", "Stream the touching points on <WORLD>_CONTACTS: on or off");
  add_switch(*command, *contacts_on);
  command->callback([&globals, &action, contacts_on] {
    action = [&globals, contacts_on] {
      World world(globals.world_options());
      return print_answer(globals, "contacts", world.stream_contacts(*contacts_on));
    };
  });

  auto name = std::make_shared<std::string>();
  auto plot_on = std::make_shared<bool>(true);
  command =
      app.add_subcommand("plot", "Stream a body on <WORLD>_BODY_<id>, where lcm-spy draws charts of it");
  command->add_option("NAME", *name, "Name of the body")->required();
  add_switch(*command, *plot_on);
  command->callback([&globals, &action, name, plot_on] {
    action = [&globals, name, plot_on] {
      World world(globals.world_options());
      const Answer answer = world.watch(*name, *plot_on);
      return print_answer(globals, answer.accepted() ? body_channel_name(world.name(), answer.body) : *name,
                          answer);
    };
  });
}

}  // namespace

void add_control(CLI::App& app, const Globals& globals, Action& action) {
  add_plain(app, globals, action, "pause", "Stop simulated time", &World::pause);
  add_plain(app, globals, action, "resume", "Let simulated time run", &World::resume);
  add_step(app, globals, action);
  add_plain(app, globals, action, "reset", "The world as it was at the start", &World::reset);
  add_named(app, globals, action, "snapshot", "Keep the world as it is under a name", &World::snapshot);
  add_named(app, globals, action, "restore", "The world as it was at a snapshot", &World::restore);
  add_streams(app, globals, action);
}

}  // namespace tumble::client
