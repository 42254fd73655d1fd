// The answer to one command, and the ack_t messages that carry answers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "protocol/channels.h"
#include "tumble/ack_t.hpp"

namespace tumble {

/// What became of a command.
struct Outcome {
  Status status = Status::applied;
  std::int64_t step = -1;  ///< It acts from this step on; -1 if refused.
  std::int32_t body = -1, generation = -1;
  std::string detail{};  ///< For people; empty if all is well.
};

struct Acknowledgement {
  std::int64_t client = 0, sequence = 0;
  Outcome outcome;
};

/// Packs `answers` into as few messages as fit the limit and hands each to `send`; utime, session and step come from
/// `head`. Details are cut to kMaxAckDetail.
void pack_acknowledgements(std::span<const Acknowledgement> answers, const ack_t& head,
                           std::size_t payload_limit, const std::function<void(const ack_t&)>& send);

}  // namespace tumble
