// tumble push and tumble torque: a force or torque on a body for a while.
#include "commands/command.h"

namespace tumble::client {
namespace {

int send_push(const Globals& globals, const Push& push) {
  World world(globals.world_options());
  return print_answer(globals, push.body, world.push(push));
}

void add_common(CLI::App& command, Push& push) {
  command.add_option("NAME", push.body, "Name of the body")->required();
  command.add_option("--seconds", push.seconds, "How long it acts, simulated [s]; 0: one step")
      ->required()
      ->check(CLI::Range(0.0, kMaxDuration));
  add_choice<Frame>(command, "--frame", push.frame, {{"world", Frame::world}, {"body", Frame::body}},
                    "Axes in which it is given; default world");
  command.add_option("--start-step", push.start_step, "First step it acts in; default: the next one")
      ->check(CLI::NonNegativeNumber);
}

}  // namespace

void add_push(CLI::App& app, const Globals& globals, Action& action) {
  auto push = std::make_shared<Push>();
  auto* command = app.add_subcommand("push", "Push a body with a force [N] for some seconds");
  add_common(*command, *push);
  add_numbers(*command, "--force", push->force.data(), 3, "Force [N]")->required();
  add_numbers(*command, "--at", push->point.data(), 3,
              "Where it acts: from the centre of mass, in the body's axes [m]; moves with the body");
  command->callback(
      [&globals, &action, push] { action = [&globals, push] { return send_push(globals, *push); }; });

  auto twist = std::make_shared<Push>();
  command = app.add_subcommand("torque", "Twist a body with a torque [N m] for some seconds");
  add_common(*command, *twist);
  add_numbers(*command, "--torque", twist->torque.data(), 3, "Torque [N m]")->required();
  command->callback(
      [&globals, &action, twist] { action = [&globals, twist] { return send_push(globals, *twist); }; });
}

}  // namespace tumble::client
