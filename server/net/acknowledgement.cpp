// See acknowledgement.h.
#include "net/acknowledgement.h"

namespace tumble {
namespace {

std::size_t row_bytes(const Acknowledgement& answer) {
  return 8 + 8 + 1 + 8 + 4 + 4 + (4 + std::min(answer.outcome.detail.size(), kMaxAckDetail) + 1);
}

void push(const Acknowledgement& answer, ack_t& message) {
  ++message.n;
  message.client.push_back(answer.client);
  message.sequence.push_back(answer.sequence);
  message.status.push_back(static_cast<std::int8_t>(answer.outcome.status));
  message.applied_step.push_back(answer.outcome.step);
  message.body.push_back(answer.outcome.body);
  message.generation.push_back(answer.outcome.generation);
  message.detail.push_back(answer.outcome.detail.substr(0, kMaxAckDetail));
}

}  // namespace

void pack_acknowledgements(std::span<const Acknowledgement> answers, const ack_t& head,
                           std::size_t payload_limit, const std::function<void(const ack_t&)>& send) {
  ack_t empty{};
  empty.utime = head.utime;
  empty.session = head.session;
  empty.step = head.step;
  const auto fixed = static_cast<std::size_t>(empty.getEncodedSize());
  ack_t message = empty;
  std::size_t size = fixed;
  for (const Acknowledgement& answer : answers) {
    const std::size_t row = row_bytes(answer);
    if (message.n > 0 && size + row > payload_limit) {
      send(message);
      message = empty;
      size = fixed;
    }
    push(answer, message);
    size += row;
  }
  if (message.n > 0) send(message);
}

}  // namespace tumble
