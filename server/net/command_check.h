// The ranges of the numbers in a command or query, as protocol/channels.h sets them.
#pragma once

#include "net/acknowledgement.h"
#include "protocol/codec.h"

namespace tumble {

/// Status::applied if every number the verb reads is finite and in its range, else the status and the field.
Outcome check_values(const force_command_t& command);
Outcome check_values(const control_t& command);
/// Only whether its numbers are finite: what they mean is looked at where the query is answered.
Outcome check_values(const query_t& query);

}  // namespace tumble
