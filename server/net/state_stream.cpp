// See state_stream.h.
#include "net/state_stream.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "protocol/columns.h"
#include "protocol/packed.h"

namespace tumble {
namespace {

/// id, generation, flags and 13 doubles.
constexpr std::size_t kBytesPerBody = 4 + 4 + 1 + 13 * 8;
/// Publications that repeat a body's last change: with 10 % loss one body in a thousand then waits for its refresh.
constexpr std::uint8_t kRepeats = 2;

/// The smallest cube of a power of two, but no smaller than kPackedEdge, around the bodies.
void enclose(const WorldView& view, std::span<const std::uint32_t> slots, packed_t& message) {
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const Vec3 p = Eigen::Map<const Vec3>(view.bodies[slots[i]].values.data());
    low = i == 0 ? p : low.cwiseMin(p);
    high = i == 0 ? p : high.cwiseMax(p);
  }
  message.edge = kPackedEdge;
  while (message.edge < (high - low).maxCoeff()) message.edge *= 2.0;
  std::copy_n(low.data(), 3, message.origin);
}

void resize(state_t& message, std::size_t count) {
  message.n = static_cast<std::int32_t>(count);
  message.id.resize(count);
  message.generation.resize(count);
  message.flags.resize(count);
  for (std::vector<double>* component : motion_columns(message)) component->resize(count);
}

}  // namespace

StateStream::StateStream(std::size_t payload_limit, Encoding encoding) {
  if (encoding == Encoding::exact) {
    bodies_per_message_ = rows_that_fit<state_t>(payload_limit, kBytesPerBody);
    ids_per_message_ = std::numeric_limits<std::uint32_t>::max();
  } else {
    bodies_per_message_ = rows_that_fit<packed_t>(payload_limit, kPackedRecord);
    ids_per_message_ = kPackedIds;
  }
}

void StateStream::begin(const WorldView& view, std::int64_t now_ns) {
  view_ = &view;
  if (view.session != session_) {
    session_ = view.session;
    sent_.clear();
    repeats_.clear();
    refresh_ = Rolling(kRefreshPeriod);
    refresh_slot_ = 0;
  }
  select(now_ns);
  cut_chunks();
}

void StateStream::select(std::int64_t now_ns) {
  const auto count = static_cast<std::uint32_t>(view_->bodies.size());
  sent_.resize(count);
  repeats_.resize(count);
  due_.assign(count, 0);
  for (std::uint32_t left = refresh_.advance(now_ns, count); left > 0; --left) {
    if (refresh_slot_ >= count) refresh_slot_ = 0;
    due_[refresh_slot_++] = 1;
  }
  selected_.clear();
  for (std::uint32_t slot = 0; slot < count; ++slot) {
    const BodyView& body = view_->bodies[slot];
    const bool changed = body != sent_[slot], again = !changed && repeats_[slot] > 0;
    if (changed) repeats_[slot] = kRepeats;
    if (again) --repeats_[slot];
    if (body.exists && (changed || again || due_[slot] != 0 || view_->whole)) selected_.push_back(slot);
    sent_[slot] = body;
  }
}

void StateStream::cut_chunks() {
  chunk_ = 0;
  chunk_ends_.clear();
  std::size_t first = 0;
  for (std::size_t i = 1; i < selected_.size(); ++i) {
    if (i - first < bodies_per_message_ && selected_[i] - selected_[first] < ids_per_message_) continue;
    chunk_ends_.push_back(i);
    first = i;
  }
  chunk_ends_.push_back(selected_.size());
}

template <typename Message>
bool StateStream::take_chunk(Message& message, std::span<const std::uint32_t>& slots) {
  if (chunk_ == chunk_ends_.size()) return false;
  message.utime = view_->utime;
  message.session = view_->session;
  message.step = view_->step;
  message.time = view_->time;
  message.state_hash = std::bit_cast<std::int64_t>(view_->state_hash);
  message.catalog_epoch = view_->catalog->epoch;
  message.num_bodies = view_->catalog->num_bodies;
  message.chunk = static_cast<std::int16_t>(chunk_);
  message.num_chunks = static_cast<std::int16_t>(chunk_ends_.size());
  const std::size_t first = chunk_ == 0 ? 0 : chunk_ends_[chunk_ - 1];
  slots = std::span<const std::uint32_t>(selected_).subspan(first, chunk_ends_[chunk_] - first);
  ++chunk_;
  return true;
}

bool StateStream::next(state_t& message) {
  std::span<const std::uint32_t> slots;
  if (!take_chunk(message, slots)) return false;
  resize(message, slots.size());
  const auto arrays = motion_columns(message);
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const BodyView& body = view_->bodies[slots[i]];
    message.id[i] = static_cast<std::int32_t>(slots[i]);
    message.generation[i] = static_cast<std::int32_t>(body.generation);
    message.flags[i] = body.flags;
    for (std::size_t k = 0; k < arrays.size(); ++k) (*arrays[k])[i] = body.values[k];
  }
  return true;
}

bool StateStream::next(packed_t& message) {
  std::span<const std::uint32_t> slots;
  if (!take_chunk(message, slots)) return false;
  enclose(*view_, slots, message);
  message.first_id = slots.empty() ? 0 : static_cast<std::int32_t>(slots.front());
  message.n = static_cast<std::int32_t>(slots.size());
  message.records.resize(slots.size() * kPackedRecord);
  message.size = static_cast<std::int32_t>(message.records.size());
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const BodyView& body = view_->bodies[slots[i]];
    pack_body({slots[i], body.generation, body.flags, body.values}, message,
              PackedRecord(message.records.data() + i * kPackedRecord, kPackedRecord));
  }
  return true;
}

}  // namespace tumble
