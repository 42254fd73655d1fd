// The ranges of the numbers in a command, as protocol/channels.h sets them.
#pragma once

#include "net/acknowledgement.h"
#include "protocol/codec.h"

namespace tumble {

/// Status::applied if every number the verb reads is finite and in its range, else the status and the field.
Outcome check_values(const force_command_t& command);
Outcome check_values(const control_t& command);

}  // namespace tumble
