// Questions of clients to the world between two steps: query_t in, hits_t out. Whatever is wrong with a question is
// said in its answer.
#pragma once

#include <cstddef>
#include <string>

#include "protocol/channels.h"
#include "tumble/hits_t.hpp"
#include "tumble/query_t.hpp"
#include "world/world.h"

namespace tumble {

/// The answer to `query`, in at most `payload_limit` bytes. Leaves utime and session to the caller.
hits_t answer_query(const World& world, const query_t& query, std::size_t payload_limit);
/// Why it is not answered.
hits_t refuse_query(const query_t& query, Status status, std::string detail);

}  // namespace tumble
