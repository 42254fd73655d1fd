// See state_publisher.h.
#include "net/state_publisher.h"

#include <algorithm>
#include <cmath>

#include "protocol/codec.h"
#include "protocol/columns.h"
#include "tumble/body_state_t.hpp"
#include "tumble/contacts_t.hpp"
#include "tumble/pushes_t.hpp"

namespace tumble {
namespace {

/// Two ids and ten doubles.
constexpr std::size_t kBytesPerContact = 2 * 4 + 10 * 8;
/// An id and ten doubles.
constexpr std::size_t kBytesPerPush = 4 + 10 * 8;

void push_contact(const ContactView& contact, contacts_t& message) {
  ++message.n;
  message.body_a.push_back(static_cast<std::int32_t>(contact.body_a));
  message.body_b.push_back(static_cast<std::int32_t>(contact.body_b));
  push_components(contact.p_W, message.px, message.py, message.pz);
  push_components(contact.n_W, message.nx, message.ny, message.nz);
  message.separation.push_back(contact.separation);
  push_components(contact.impulse_W, message.jx, message.jy, message.jz);
}

}  // namespace

StatePublisher::StatePublisher(std::string world_name, std::size_t payload_limit, Encoding encoding)
    : world_name_(std::move(world_name)),
      state_channel_(channel_name(world_name_, kStateSuffix)),
      packed_channel_(channel_name(world_name_, kPackedSuffix)),
      catalog_channel_(channel_name(world_name_, kCatalogSuffix)),
      contacts_channel_(channel_name(world_name_, kContactsSuffix)),
      pushes_channel_(channel_name(world_name_, kPushesSuffix)),
      encoding_(encoding),
      contacts_per_message_(rows_that_fit<contacts_t>(payload_limit, kBytesPerContact)),
      pushes_per_message_(rows_that_fit<pushes_t>(payload_limit, kBytesPerPush)),
      state_(payload_limit, encoding),
      catalog_(payload_limit) {}

void StatePublisher::begin(const WorldView& view, std::int64_t now_ns) {
  view_ = &view;
  watched_ = 0;
  contact_chunk_ = 0;
  num_contact_chunks_ = view.has_contacts
                            ? std::max<std::size_t>(1, (view.contacts.size() + contacts_per_message_ - 1) /
                                                           contacts_per_message_)
                            : 0;
  pushes_told_ = !view.has_pushes;
  state_.begin(view, now_ns);
  catalog_.begin(view, now_ns);
}

bool StatePublisher::next(std::string& channel, std::vector<std::uint8_t>& bytes) {
  if (watched_ < view_->watched.size()) {
    encode_watched(view_->watched[watched_++], channel, bytes);
    return true;
  }
  if (encode_state(channel, bytes)) return true;
  if (catalog_.next(catalog_message_)) {
    channel = catalog_channel_;
    encode(catalog_message_, bytes);
    return true;
  }
  if (contact_chunk_ < num_contact_chunks_) {
    channel = contacts_channel_;
    encode_contacts(bytes);
    return true;
  }
  if (!pushes_told_) {
    pushes_told_ = true;
    channel = pushes_channel_;
    encode_pushes(bytes);
    return true;
  }
  return false;
}

bool StatePublisher::encode_state(std::string& channel, std::vector<std::uint8_t>& bytes) {
  if (encoding_ == Encoding::packed) {
    if (!state_.next(packed_message_)) return false;
    channel = packed_channel_;
    encode(packed_message_, bytes);
  } else {
    if (!state_.next(state_message_)) return false;
    channel = state_channel_;
    encode(state_message_, bytes);
  }
  return true;
}

void StatePublisher::encode_pushes(std::vector<std::uint8_t>& bytes) const {
  pushes_t message{};
  message.utime = view_->utime;
  message.session = view_->session;
  message.step = view_->step;
  message.time = view_->time;
  message.num_pushes = static_cast<std::int32_t>(view_->pushes.size());
  message.n = static_cast<std::int32_t>(std::min(view_->pushes.size(), pushes_per_message_));
  for (std::size_t i = 0; i < static_cast<std::size_t>(message.n); ++i) {
    const PushView& push = view_->pushes[i];
    message.body.push_back(static_cast<std::int32_t>(push.body));
    push_components(push.p_W, message.px, message.py, message.pz);
    push_components(push.force_W, message.fx, message.fy, message.fz);
    push_components(push.torque_W, message.tx, message.ty, message.tz);
    message.seconds_left.push_back(push.seconds_left);
  }
  encode(message, bytes);
}

void StatePublisher::encode_watched(const WatchedView& watched, std::string& channel,
                                    std::vector<std::uint8_t>& bytes) const {
  const BodyView& body = view_->bodies[watched.slot];
  const std::array<double, 13>& x = body.values;
  body_state_t message{};
  message.utime = view_->utime;
  message.session = view_->session;
  message.step = view_->step;
  message.time = view_->time;
  message.id = static_cast<std::int32_t>(watched.slot);
  message.generation = static_cast<std::int32_t>(body.generation);
  message.flags = body.flags;
  if (const auto& model = view_->catalog->models[watched.slot]) message.name = model->name;
  std::copy_n(x.begin(), 3, message.position);
  std::copy_n(x.begin() + 3, 4, message.orientation);
  std::copy_n(x.begin() + 7, 3, message.velocity);
  std::copy_n(x.begin() + 10, 3, message.angular_velocity);
  std::copy_n(watched.L.data(), 3, message.angular_momentum);
  message.speed = std::sqrt(x[7] * x[7] + x[8] * x[8] + x[9] * x[9]);
  message.kinetic_energy = watched.kinetic_energy;
  channel = body_channel_name(world_name_, message.id);
  encode(message, bytes);
}

void StatePublisher::encode_contacts(std::vector<std::uint8_t>& bytes) {
  contacts_t message{};
  message.utime = view_->utime;
  message.session = view_->session;
  message.step = view_->step;
  message.time = view_->time;
  message.num_contacts = static_cast<std::int32_t>(view_->contacts.size());
  message.chunk = static_cast<std::int16_t>(contact_chunk_);
  message.num_chunks = static_cast<std::int16_t>(num_contact_chunks_);
  const std::size_t first = contact_chunk_ * contacts_per_message_;
  const std::size_t end = std::min(view_->contacts.size(), first + contacts_per_message_);
  for (std::size_t i = first; i < end; ++i) push_contact(view_->contacts[i], message);
  ++contact_chunk_;
  encode(message, bytes);
}

}  // namespace tumble
