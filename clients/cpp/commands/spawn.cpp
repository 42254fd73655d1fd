// tumble spawn, set and remove: bodies come, are put somewhere, and go.
#include <algorithm>

#include "commands/command.h"

namespace tumble::client {
namespace {

struct SpawnArguments {
  Spawn spawn;
  std::vector<double> size, color;
};

std::size_t num_lengths(std::int8_t shape_type) {
  switch (shape_type) {
    case catalog_t::SHAPE_SPHERE:
      return 1;
    case catalog_t::SHAPE_CAPSULE:
    case catalog_t::SHAPE_CYLINDER:
    case catalog_t::SHAPE_CONE:
      return 2;
  }
  return 3;
}

int spawn(const Globals& globals, const SpawnArguments& arguments) {
  World world(globals.world_options());
  return print_answer(globals, arguments.spawn.name, world.spawn(arguments.spawn));
}

/// Throws CLI::ValidationError if there are not as many lengths as the shape has.
void take_lists(SpawnArguments& arguments) {
  Spawn& spawn = arguments.spawn;
  const std::size_t expected = num_lengths(spawn.shape_type);
  if (arguments.size.size() != expected) {
    throw CLI::ValidationError("--size", std::string("a ") + shape_type_name(spawn.shape_type) + " has " +
                                             std::to_string(expected) +
                                             (expected == 1   ? " length (its radius)"
                                              : expected == 2 ? " lengths (radius, length)"
                                                              : " lengths (along x, y, z)") +
                                             ", given were " + std::to_string(arguments.size.size()));
  }
  std::copy(arguments.size.begin(), arguments.size.end(), spawn.size.begin());
  std::transform(arguments.color.begin(), arguments.color.end(), spawn.color.begin(),
                 [](double value) { return static_cast<float>(value); });
}

void add_motion(CLI::App& command, Vec3& position, Quat& orientation, Vec3& velocity,
                Vec3& angular_velocity) {
  add_numbers(command, "--at", position.data(), 3, "Centre of mass in the world frame [m]")->required();
  add_numbers(command, "--orientation", orientation.data(), 4,
              "Unit quaternion, scalar first; default 1 0 0 0");
  add_numbers(command, "--velocity", velocity.data(), 3, "Of the centre of mass [m/s]; default 0 0 0");
  add_numbers(command, "--spin", angular_velocity.data(), 3, "Angular velocity [rad/s]; default 0 0 0");
}

void add_spawn_command(CLI::App& app, const Globals& globals, Action& action) {
  auto arguments = std::make_shared<SpawnArguments>();
  Spawn& body = arguments->spawn;
  auto* command = app.add_subcommand("spawn", "Put a new body into the world");
  add_choice<std::int8_t>(*command, "SHAPE", body.shape_type,
                          {{"sphere", catalog_t::SHAPE_SPHERE},
                           {"box", catalog_t::SHAPE_BOX},
                           {"capsule", catalog_t::SHAPE_CAPSULE},
                           {"cylinder", catalog_t::SHAPE_CYLINDER},
                           {"cone", catalog_t::SHAPE_CONE},
                           {"ellipsoid", catalog_t::SHAPE_ELLIPSOID}},
                          "What it looks like")
      ->required();
  command->add_option("--name", body.name, "Its name, new in the world")->required();
  command
      ->add_option("--size", arguments->size,
                   "[m] sphere: radius; capsule, cylinder, cone: radius, length (of a capsule the straight "
                   "part); box: "
                   "three edges; ellipsoid: three half axes")
      ->required()
      ->expected(1, 3)
      ->check(CLI::PositiveNumber);
  command->add_option("--mass", body.mass, "[kg]; default: from a density of 1000 kg/m^3")
      ->check(CLI::PositiveNumber);
  add_motion(*command, body.position, body.orientation, body.velocity, body.angular_velocity);
  command->add_option("--friction", body.friction, "Coulomb's mu; default 0.5")
      ->check(CLI::Range(0.0, kMaxFriction));
  command->add_option("--restitution", body.restitution, "0..1; default 0")->check(CLI::Range(0.0, 1.0));
  command->add_option("--color", arguments->color, "Red, green, blue 0..1, for viewers")
      ->expected(3)
      ->check(CLI::Range(0.0, 1.0));
  add_choice<std::int8_t>(*command, "--type", body.body_type,
                          {{"dynamic", catalog_t::TYPE_DYNAMIC},
                           {"static", catalog_t::TYPE_STATIC},
                           {"kinematic", catalog_t::TYPE_KINEMATIC}},
                          "How it moves; default dynamic");
  command->callback([&globals, &action, arguments] {
    take_lists(*arguments);
    action = [&globals, arguments] { return spawn(globals, *arguments); };
  });
}

}  // namespace

void add_spawn(CLI::App& app, const Globals& globals, Action& action) {
  add_spawn_command(app, globals, action);

  auto name = std::make_shared<std::string>();
  auto motion = std::make_shared<Motion>();
  auto* command = app.add_subcommand("set", "Put a body somewhere, with a velocity");
  command->add_option("NAME", *name, "Name of the body")->required();
  add_motion(*command, motion->position, motion->orientation, motion->velocity, motion->angular_velocity);
  command->callback([&globals, &action, name, motion] {
    action = [&globals, name, motion] {
      World world(globals.world_options());
      return print_answer(globals, *name, world.set_motion(*name, *motion));
    };
  });

  auto names = std::make_shared<std::vector<std::string>>();
  command = app.add_subcommand("remove", "Take bodies out of the world");
  command->add_option("NAME", *names, "Names of the bodies")->required();
  command->callback([&globals, &action, names] {
    action = [&globals, names] {
      World world(globals.world_options());
      int status = kDone;
      for (const std::string& body : *names)
        status = std::max(status, print_answer(globals, body, world.remove(body)));
      return status;
    };
  });
}

}  // namespace tumble::client
