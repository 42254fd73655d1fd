// What commands do to the world. Form and ranges were checked by the inbox; here the world has its say: does the body
// exist, is the name free. A refused command has changed nothing.
#pragma once

#include "net/acknowledgement.h"
#include "tumble/control_t.hpp"
#include "tumble/force_command_t.hpp"
#include "world/world.h"

namespace tumble {

/// Outcomes carry the world's step count as the step from which the command acts.
Outcome apply_force(World& world, const force_command_t& command);
Outcome apply_spawn(World& world, const control_t& command);
Outcome apply_remove(World& world, const control_t& command);
Outcome apply_set_state(World& world, const control_t& command);

/// Status::applied and the body's id if it exists with this generation, else why not.
Outcome find_body(const World& world, std::int32_t index, std::int32_t generation);

}  // namespace tumble
