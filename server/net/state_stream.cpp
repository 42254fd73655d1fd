// See state_stream.h.
#include "net/state_stream.h"

#include <algorithm>
#include <array>
#include <bit>

namespace tumble {
namespace {

/// id, generation, flags and 13 doubles.
constexpr std::size_t kBytesPerBody = 4 + 4 + 1 + 13 * 8;

/// The component arrays in the order of BodyView::values.
std::array<std::vector<double>*, 13> components(state_t& message) {
  return {&message.px, &message.py, &message.pz, &message.qw, &message.qx, &message.qy, &message.qz,
          &message.vx, &message.vy, &message.vz, &message.wx, &message.wy, &message.wz};
}

void resize(state_t& message, std::size_t count) {
  message.n = static_cast<std::int32_t>(count);
  message.id.resize(count);
  message.generation.resize(count);
  message.flags.resize(count);
  for (std::vector<double>* component : components(message)) component->resize(count);
}

}  // namespace

StateStream::StateStream(std::size_t payload_limit) {
  state_t empty{};
  bodies_per_message_ = (payload_limit - static_cast<std::size_t>(empty.getEncodedSize())) / kBytesPerBody;
}

void StateStream::begin(const WorldView& view, std::int64_t now_ns) {
  view_ = &view;
  if (view.session != session_) {
    session_ = view.session;
    sent_.clear();
    refresh_ = Rolling(kRefreshPeriod);
    refresh_slot_ = 0;
  }
  select(now_ns);
  num_chunks_ = std::max<std::size_t>(1, (selected_.size() + bodies_per_message_ - 1) / bodies_per_message_);
  chunk_ = 0;
}

void StateStream::select(std::int64_t now_ns) {
  const auto count = static_cast<std::uint32_t>(view_->bodies.size());
  sent_.resize(count);
  due_.assign(count, 0);
  for (std::uint32_t left = refresh_.advance(now_ns, count); left > 0; --left) {
    if (refresh_slot_ >= count) refresh_slot_ = 0;
    due_[refresh_slot_++] = 1;
  }
  selected_.clear();
  for (std::uint32_t slot = 0; slot < count; ++slot) {
    const BodyView& body = view_->bodies[slot];
    if (body.exists && (due_[slot] != 0 || body != sent_[slot])) selected_.push_back(slot);
    sent_[slot] = body;
  }
}

bool StateStream::next(state_t& message) {
  if (chunk_ == num_chunks_) return false;
  message.utime = view_->utime;
  message.session = view_->session;
  message.step = view_->step;
  message.time = view_->time;
  message.state_hash = std::bit_cast<std::int64_t>(view_->state_hash);
  message.catalog_epoch = view_->catalog->epoch;
  message.num_bodies = view_->catalog->num_bodies;
  message.chunk = static_cast<std::int16_t>(chunk_);
  message.num_chunks = static_cast<std::int16_t>(num_chunks_);
  const std::size_t first = chunk_ * bodies_per_message_;
  const std::size_t count = std::min(bodies_per_message_, selected_.size() - first);
  resize(message, count);
  const auto arrays = components(message);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t slot = selected_[first + i];
    const BodyView& body = view_->bodies[slot];
    message.id[i] = static_cast<std::int32_t>(slot);
    message.generation[i] = static_cast<std::int32_t>(body.generation);
    message.flags[i] = body.flags;
    for (std::size_t k = 0; k < arrays.size(); ++k) (*arrays[k])[i] = body.values[k];
  }
  ++chunk_;
  return true;
}

}  // namespace tumble
