// See catalog_stream.h.
#include "net/catalog_stream.h"

#include <algorithm>
#include <utility>

namespace tumble {
namespace {

// Bytes of a row on the wire; a body's name comes on top.
constexpr std::size_t kBodyRow = 4 + 4 + (4 + 1) + 1 + 4 + 10 * 8;
constexpr std::size_t kShapeRow = 4 + 4 + 1 + 4 + 10 * 8 + 6 * 4;
constexpr std::size_t kVertexRow = 4 + 4 + 4 + 3 * 4;

std::int8_t type_code(BodyType type) {
  switch (type) {
    case BodyType::fixed:
      return catalog_t::TYPE_STATIC;
    case BodyType::dynamic:
      return catalog_t::TYPE_DYNAMIC;
    case BodyType::kinematic:
      return catalog_t::TYPE_KINEMATIC;
  }
  return catalog_t::TYPE_STATIC;
}

struct ShapeCode {
  std::int8_t type;
  Vec3 size;
  const ConvexHull* hull = nullptr;
  const Aabb* bounds = nullptr;  // of a surface

  std::size_t vertices() const { return hull ? hull->vertices.size() : bounds ? 8 : 0; }
  Vec3 vertex(std::size_t i) const {
    if (hull) return hull->vertices[i];
    const auto side = [&](int axis) { return i >> axis & 1 ? bounds->upper[axis] : bounds->lower[axis]; };
    return {side(0), side(1), side(2)};
  }
};

ShapeCode surface_code(std::int8_t type, const Aabb& bounds) {
  return {type, bounds.upper - bounds.lower, nullptr, &bounds};
}

struct ShapeCoder {
  ShapeCode operator()(const HalfSpace&) const { return {catalog_t::SHAPE_HALF_SPACE, Vec3::Zero()}; }
  ShapeCode operator()(const Sphere& s) const { return {catalog_t::SHAPE_SPHERE, Vec3(s.radius, 0.0, 0.0)}; }
  ShapeCode operator()(const Capsule& c) const {
    return {catalog_t::SHAPE_CAPSULE, Vec3(c.radius, 2.0 * c.half_length, 0.0)};
  }
  ShapeCode operator()(const Box& b) const { return {catalog_t::SHAPE_BOX, 2.0 * b.half_extents}; }
  ShapeCode operator()(const Cylinder& c) const {
    return {catalog_t::SHAPE_CYLINDER, Vec3(c.radius, 2.0 * c.half_length, 0.0)};
  }
  ShapeCode operator()(const Cone& c) const {
    return {catalog_t::SHAPE_CONE, Vec3(c.radius, 2.0 * c.half_length, 0.0)};
  }
  ShapeCode operator()(const Ellipsoid& e) const { return {catalog_t::SHAPE_ELLIPSOID, e.half_axes}; }
  ShapeCode operator()(const TriangleMeshPointer& m) const {
    return surface_code(catalog_t::SHAPE_TRIANGLE_MESH, m->bounds());
  }
  ShapeCode operator()(const HeightFieldPointer& h) const {
    return surface_code(catalog_t::SHAPE_HEIGHT_FIELD, h->bounds());
  }
  ShapeCode operator()(const HullPointer& h) const { return {catalog_t::SHAPE_HULL, Vec3::Zero(), h.get()}; }
};

void push_body(const BodyModel& model, catalog_t& message) {
  ++message.n;
  message.id.push_back(static_cast<std::int32_t>(model.id.index));
  message.generation.push_back(static_cast<std::int32_t>(model.id.generation));
  message.name.push_back(model.name);
  message.type.push_back(type_code(model.type));
  message.body_shapes.push_back(static_cast<std::int32_t>(model.parts.size()));
  message.mass.push_back(model.mass);
  message.ixx.push_back(model.I_B(0, 0));
  message.iyy.push_back(model.I_B(1, 1));
  message.izz.push_back(model.I_B(2, 2));
  message.ixy.push_back(model.I_B(0, 1));
  message.ixz.push_back(model.I_B(0, 2));
  message.iyz.push_back(model.I_B(1, 2));
  message.cx.push_back(model.p_LB.x());
  message.cy.push_back(model.p_LB.y());
  message.cz.push_back(model.p_LB.z());
}

void push_shape(const BodyModel& model, std::size_t number, const ShapeCode& code, catalog_t& message) {
  const BodyModel::Part& part = model.parts[number];
  ++message.num_shapes;
  message.shape_body.push_back(static_cast<std::int32_t>(model.id.index));
  message.shape_number.push_back(static_cast<std::int32_t>(number));
  message.shape_type.push_back(code.type);
  message.shape_vertices.push_back(static_cast<std::int32_t>(code.vertices()));
  message.size_x.push_back(code.size.x());
  message.size_y.push_back(code.size.y());
  message.size_z.push_back(code.size.z());
  message.shape_px.push_back(part.X_BS.p.x());
  message.shape_py.push_back(part.X_BS.p.y());
  message.shape_pz.push_back(part.X_BS.p.z());
  message.shape_qw.push_back(part.X_BS.q.w());
  message.shape_qx.push_back(part.X_BS.q.x());
  message.shape_qy.push_back(part.X_BS.q.y());
  message.shape_qz.push_back(part.X_BS.q.z());
  message.friction.push_back(static_cast<float>(part.material.friction));
  message.restitution.push_back(static_cast<float>(part.material.restitution));
  message.red.push_back(part.color[0]);
  message.green.push_back(part.color[1]);
  message.blue.push_back(part.color[2]);
  message.alpha.push_back(part.color[3]);
}

void push_vertex(const BodyModel& model, std::size_t part, std::size_t number, const Vec3& p,
                 catalog_t& message) {
  ++message.num_vertices;
  message.vertex_body.push_back(static_cast<std::int32_t>(model.id.index));
  message.vertex_shape.push_back(static_cast<std::int32_t>(part));
  message.vertex_number.push_back(static_cast<std::int32_t>(number));
  message.vertex_x.push_back(static_cast<float>(p.x()));
  message.vertex_y.push_back(static_cast<float>(p.y()));
  message.vertex_z.push_back(static_cast<float>(p.z()));
}

/// Takes `bytes` from `room` if they fit.
bool take(std::size_t& room, std::size_t bytes) {
  if (bytes > room) return false;
  room -= bytes;
  return true;
}

}  // namespace

void CatalogStream::begin(const WorldView& view, std::int64_t now_ns) {
  std::shared_ptr<const Catalog> previous = std::exchange(catalog_, view.catalog);
  utime_ = view.utime;
  if (view.session != session_) {
    session_ = view.session;
    previous = nullptr;
    round_ = Rolling(kCatalogPeriod);
    round_slot_ = 0;
  }
  if (previous && previous != catalog_) queue_changes(previous.get());
  queue_round(now_ns);
}

void CatalogStream::queue_changes(const Catalog* previous) {
  const auto& before = previous->models;
  const auto& after = catalog_->models;
  for (std::uint32_t slot = 0; slot < after.size(); ++slot) {
    const bool same = slot < before.size() && before[slot] == after[slot];
    if (same) continue;
    if (!work_.empty() && work_.back().end == slot) {
      ++work_.back().end;
    } else {
      work_.push_back({.slot = slot, .end = slot + 1});
    }
  }
}

void CatalogStream::queue_round(std::int64_t now_ns) {
  // An empty world still tells so once a round.
  const auto count = std::max<std::uint32_t>(1, static_cast<std::uint32_t>(catalog_->models.size()));
  std::uint32_t due = round_.advance(now_ns, count);
  while (due > 0) {
    if (round_slot_ >= count) round_slot_ = 0;
    const std::uint32_t end = std::min(count, round_slot_ + due);
    work_.push_back({.slot = round_slot_, .end = end});
    due -= end - round_slot_;
    round_slot_ = end;
  }
}

bool CatalogStream::next(catalog_t& message) {
  if (work_.empty()) return false;
  Range& range = work_.front();
  message = {};
  message.utime = utime_;
  message.session = session_;
  message.epoch = catalog_->epoch;
  message.num_bodies = catalog_->num_bodies;
  message.id_limit = static_cast<std::int32_t>(catalog_->models.size());
  const std::uint32_t end = std::min(range.end, static_cast<std::uint32_t>(catalog_->models.size()));
  // The rest of a body that is listed already belongs to the message before: this one lists those after it.
  const std::uint32_t first = range.listed ? range.slot + 1 : range.slot;
  std::size_t room = payload_limit_ - static_cast<std::size_t>(message.getEncodedSize());
  while (range.slot < end && add_body(range, message, room))
    range = {.slot = range.slot + 1, .end = range.end};
  const std::uint32_t last = std::min(range.listed ? range.slot + 1 : range.slot, end);
  message.first_id = static_cast<std::int32_t>(std::min(first, last));
  message.end_id = static_cast<std::int32_t>(last);
  if (range.slot >= end) work_.pop_front();
  return true;
}

/// Adds what is left of body range.slot; false if the room ended before it did.
bool CatalogStream::add_body(Range& range, catalog_t& message, std::size_t& room) const {
  const BodyModel* model = catalog_->models[range.slot].get();
  if (model == nullptr) return true;
  if (!range.listed) {
    if (!take(room, kBodyRow + model->name.size())) return false;
    push_body(*model, message);
    range.listed = true;
  }
  for (; range.part < model->parts.size(); ++range.part, range.part_listed = false, range.vertex = 0) {
    const ShapeCode code = std::visit(ShapeCoder(), model->parts[range.part].shape);
    if (!range.part_listed) {
      if (!take(room, kShapeRow)) return false;
      push_shape(*model, range.part, code, message);
      range.part_listed = true;
    }
    for (; range.vertex < code.vertices(); ++range.vertex) {
      if (!take(room, kVertexRow)) return false;
      push_vertex(*model, range.part, range.vertex, code.vertex(range.vertex), message);
    }
  }
  return true;
}

}  // namespace tumble
