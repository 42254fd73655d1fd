// Merging of STATE and CATALOG, see picture.h.
#include "tumble/picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "protocol/packed.h"

namespace tumble::client {
namespace {

/// The shape with this number, put in its place if it is new.
Shape& shape_for(Body& body, std::int32_t number) {
  const auto place = std::lower_bound(body.shapes.begin(), body.shapes.end(), number,
                                      [](const Shape& shape, std::int32_t n) { return shape.number < n; });
  if (place != body.shapes.end() && place->number == number) return *place;
  Shape shape;
  shape.number = number;
  return *body.shapes.insert(place, std::move(shape));
}

bool is_complete_shape(const Shape& shape) {
  if (static_cast<std::int32_t>(shape.vertices.size()) != shape.num_vertices) return false;
  return std::none_of(shape.vertices.begin(), shape.vertices.end(),
                      [](const auto& vertex) { return std::isnan(vertex[0]); });
}

bool is_complete_body(const Body& body) {
  return body.described && body.placed && static_cast<std::int32_t>(body.shapes.size()) == body.num_shapes &&
         std::all_of(body.shapes.begin(), body.shapes.end(), is_complete_shape);
}

}  // namespace

bool Picture::merge(const state_t& message) {
  if (!adopt_session(message.session, message.utime)) return false;
  // A body that a newer epoch may have removed is not brought back by a message that was overtaken.
  return merge_state(message, message.catalog_epoch >= epoch_);
}

bool Picture::merge(const packed_t& message) {
  if (!adopt_session(message.session, message.utime)) return false;
  state_t state;
  unpack(message, state);
  // Generations are cut and types are missing: the catalogue knows them. Who is not in it yet comes with a refresh.
  for (std::size_t i = 0; i < state.id.size(); ++i) {
    const Body* body = find(state.id[i]);
    const auto kept = static_cast<std::uint32_t>(state.generation[i]);
    if (body == nullptr || !body->described ||
        static_cast<std::uint32_t>(body->generation) % kPackedGenerations != kept) {
      state.generation[i] = -1;  // nobody's
      continue;
    }
    state.generation[i] = body->generation;
    if (body->type == catalog_t::TYPE_STATIC) state.flags[i] |= state_t::FLAG_STATIC;
    if (body->type == catalog_t::TYPE_KINEMATIC) state.flags[i] |= state_t::FLAG_KINEMATIC;
  }
  return merge_state(state, false);
}

bool Picture::merge_state(const state_t& message, bool may_create) {
  note_epoch(message.catalog_epoch, message.num_bodies);
  note_chunk(message);
  if (message.step >= step_) {
    step_ = message.step;
    time_ = message.time;
    state_hash_ = message.state_hash;
  }
  for (std::size_t i = 0; i < message.id.size(); ++i) {
    Body* body = body_for(message.id[i], message.generation[i], may_create);
    if (!body) continue;
    body->epoch = std::max(body->epoch, message.catalog_epoch);
    if (message.step < body->step) continue;
    body->placed = true;
    body->step = message.step;
    body->time = message.time;
    body->flags = message.flags[i];
    body->position = {message.px[i], message.py[i], message.pz[i]};
    body->orientation = {message.qw[i], message.qx[i], message.qy[i], message.qz[i]};
    body->velocity = {message.vx[i], message.vy[i], message.vz[i]};
    body->angular_velocity = {message.wx[i], message.wy[i], message.wz[i]};
  }
  return true;
}

void Picture::note_chunk(const state_t& message) {
  if (message.utime < publication_.utime) return;
  if (message.utime > publication_.utime) publication_ = {message.utime, {}};
  publication_.heard.insert(message.chunk);
  if (static_cast<int>(publication_.heard.size()) == message.num_chunks) {
    whole_step_ = std::max(whole_step_, message.step);
  }
}

bool Picture::merge(const catalog_t& message) {
  if (!adopt_session(message.session, message.utime) || message.epoch < epoch_) return false;
  note_epoch(message.epoch, message.num_bodies);
  remove_unlisted(message);
  merge_bodies(message);
  merge_shapes(message);
  merge_vertices(message);
  return true;
}

const Body* Picture::find(std::int32_t id) const {
  const auto found = bodies_.find(id);
  return found == bodies_.end() ? nullptr : &found->second;
}

const Body* Picture::find(std::string_view name) const {
  const auto found = ids_by_name_.find(name);
  return found == ids_by_name_.end() ? nullptr : find(found->second);
}

bool Picture::is_complete() const {
  return num_bodies_ >= 0 && static_cast<std::int32_t>(bodies_.size()) == num_bodies_ &&
         std::all_of(bodies_.begin(), bodies_.end(),
                     [](const auto& entry) { return is_complete_body(entry.second); });
}

bool Picture::adopt_session(std::int64_t session, std::int64_t utime) {
  if (session != session_) {
    if (utime < utime_) return false;  // a straggler of the session before
    *this = Picture();
    session_ = session;
  }
  utime_ = std::max(utime_, utime);
  return true;
}

void Picture::note_epoch(std::int64_t epoch, std::int32_t num_bodies) {
  if (epoch < epoch_) return;
  epoch_ = epoch;
  num_bodies_ = num_bodies;
}

Body* Picture::body_for(std::int32_t id, std::int32_t generation, bool may_create) {
  const auto found = bodies_.find(id);
  if (found != bodies_.end() && found->second.generation == generation) return &found->second;
  if (!may_create || (found != bodies_.end() && found->second.generation > generation)) return nullptr;
  if (found != bodies_.end()) forget_name(found->second);
  Body fresh;
  fresh.id = id;
  fresh.generation = generation;
  return &(bodies_[id] = std::move(fresh));
}

void Picture::remove_unlisted(const catalog_t& message) {
  auto entry = bodies_.lower_bound(message.first_id);
  const auto beyond =
      message.end_id >= message.id_limit ? bodies_.end() : bodies_.lower_bound(message.end_id);
  while (message.first_id < message.end_id && entry != beyond) {
    const bool listed = std::find(message.id.begin(), message.id.end(), entry->first) != message.id.end();
    if (listed || entry->second.epoch >= message.epoch) {
      ++entry;
    } else {
      forget_name(entry->second);
      entry = bodies_.erase(entry);
    }
  }
}

void Picture::forget_name(const Body& body) {
  const auto known = ids_by_name_.find(body.name);
  if (known != ids_by_name_.end() && known->second == body.id) ids_by_name_.erase(known);
}

void Picture::merge_bodies(const catalog_t& message) {
  for (std::size_t i = 0; i < message.id.size(); ++i) {
    Body* body = body_for(message.id[i], message.generation[i], true);
    if (!body) continue;
    body->epoch = std::max(body->epoch, message.epoch);
    body->described = true;
    body->name = message.name[i];
    ids_by_name_[body->name] = body->id;
    body->type = message.type[i];
    body->mass = message.mass[i];
    body->inertia = {message.ixx[i], message.iyy[i], message.izz[i],
                     message.ixy[i], message.ixz[i], message.iyz[i]};
    body->center_of_mass = {message.cx[i], message.cy[i], message.cz[i]};
    body->num_shapes = message.body_shapes[i];
  }
}

void Picture::merge_shapes(const catalog_t& message) {
  for (std::size_t i = 0; i < message.shape_body.size(); ++i) {
    const auto found = bodies_.find(message.shape_body[i]);
    if (found == bodies_.end()) continue;  // its row was lost; the next round brings both
    Shape& shape = shape_for(found->second, message.shape_number[i]);
    shape.type = message.shape_type[i];
    shape.size = {message.size_x[i], message.size_y[i], message.size_z[i]};
    shape.position = {message.shape_px[i], message.shape_py[i], message.shape_pz[i]};
    shape.orientation = {message.shape_qw[i], message.shape_qx[i], message.shape_qy[i], message.shape_qz[i]};
    shape.friction = message.friction[i];
    shape.restitution = message.restitution[i];
    shape.color = {message.red[i], message.green[i], message.blue[i], message.alpha[i]};
    shape.num_vertices = message.shape_vertices[i];
  }
}

void Picture::merge_vertices(const catalog_t& message) {
  constexpr float kUnheard = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 0; i < message.vertex_body.size(); ++i) {
    const auto found = bodies_.find(message.vertex_body[i]);
    if (found == bodies_.end()) continue;
    Shape& shape = shape_for(found->second, message.vertex_shape[i]);
    const std::int32_t number = message.vertex_number[i];
    if (number < 0 || number >= shape.num_vertices) continue;
    shape.vertices.resize(static_cast<std::size_t>(shape.num_vertices), {kUnheard, kUnheard, kUnheard});
    shape.vertices[static_cast<std::size_t>(number)] = {message.vertex_x[i], message.vertex_y[i],
                                                        message.vertex_z[i]};
  }
}

}  // namespace tumble::client
