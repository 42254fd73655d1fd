// See answer_query.h.
#include "answer_query.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "from_message.h"
#include "net/command_check.h"
#include "protocol/columns.h"
#include "world/query.h"

namespace tumble {
namespace {

constexpr std::size_t kBytesPerHit = 3 * 4 + 7 * 8 + 1;

/// A row of hits_t.
struct Hit {
  BodyId body = {};
  std::int32_t shape = -1;
  double distance = 0.0;
  Vec3 p_W = Vec3::Zero(), n_W = Vec3::Zero();
  bool inside = false;
};

Hit make_hit(const QueryHit& hit) {
  return {hit.body, static_cast<std::int32_t>(hit.geometry), hit.distance, hit.p_W, hit.normal_W, hit.inside};
}

std::vector<Hit> make_hits(const std::vector<BodyId>& bodies) {
  std::vector<Hit> hits;
  hits.reserve(bodies.size());
  for (const BodyId body : bodies) hits.push_back({.body = body});
  return hits;
}

BodyId living_body(const World& world, const char* field, std::int32_t index) {
  const auto slot = static_cast<std::uint32_t>(index);
  if (index < 0 || slot >= world.body_capacity() || !world.body(slot).exists) {
    throw std::invalid_argument(fmt::format("{}: no body has the index {}", field, index));
  }
  return world.id(slot);
}

std::vector<Hit> find_closest(const World& world, const query_t& query) {
  const BodyId a = living_body(world, "body_a", query.body_a), b = living_body(world, "body_b", query.body_b);
  const std::optional<ClosestPoints> found = compute_closest_points(world, a, b);
  if (!found) return {};
  return {{.body = b, .distance = found->distance, .p_W = found->p_WA, .n_W = found->normal_W}};
}

std::vector<Hit> find_hits(const World& world, const query_t& query) {
  const Vec3 origin = to_vector(query.origin), direction = to_vector(query.direction);
  const double length = query.length == 0.0 ? kEndless : query.length;
  const BodyFilter filter = [&](BodyId body) {
    return static_cast<std::int64_t>(body.index) != query.ignored;
  };
  std::vector<Hit> hits;
  switch (query.kind) {
    case query_t::KIND_RAY:
      if (const auto hit = cast_ray(world, origin, direction, length, filter)) hits.push_back(make_hit(*hit));
      return hits;
    case query_t::KIND_RAY_ALL:
      for (const QueryHit& hit : cast_ray_through(world, origin, direction, length, filter)) {
        hits.push_back(make_hit(hit));
      }
      return hits;
    case query_t::KIND_CAST: {
      const Pose X_WS{to_quaternion(query.orientation), origin};
      if (const auto hit =
              cast_shape(world, make_shape(query.shape_type, query.size), X_WS, direction, filter)) {
        hits.push_back(make_hit(*hit));
      }
      return hits;
    }
    case query_t::KIND_OVERLAP: {
      const Pose X_WS{to_quaternion(query.orientation), origin};
      return make_hits(find_overlapping(world, make_shape(query.shape_type, query.size), X_WS, filter));
    }
    case query_t::KIND_BOX:
      return make_hits(find_in_box(world, {origin, direction}, filter));
    case query_t::KIND_CLOSEST:
      return find_closest(world, query);
    default:
      throw std::invalid_argument(fmt::format("kind: {} is not known", query.kind));
  }
}

void push_hit(const Hit& hit, hits_t& message) {
  ++message.n;
  message.body.push_back(static_cast<std::int32_t>(hit.body.index));
  message.generation.push_back(static_cast<std::int32_t>(hit.body.generation));
  message.shape.push_back(hit.shape);
  message.distance.push_back(hit.distance);
  push_components(hit.p_W, message.px, message.py, message.pz);
  push_components(hit.n_W, message.nx, message.ny, message.nz);
  message.inside.push_back(hit.inside ? 1 : 0);
}

hits_t make_answer(const query_t& query) {
  hits_t answer{};
  answer.client = query.client;
  answer.sequence = query.sequence;
  return answer;
}

}  // namespace

hits_t refuse_query(const query_t& query, Status status, std::string detail) {
  hits_t answer = make_answer(query);
  detail.resize(std::min(detail.size(), kMaxAckDetail));
  answer.status = static_cast<std::int8_t>(status);
  answer.detail = std::move(detail);
  return answer;
}

hits_t answer_query(const World& world, const query_t& query, std::size_t payload_limit) {
  hits_t answer = make_answer(query);
  answer.step = static_cast<std::int64_t>(world.step_count());
  answer.time = world.time();
  if (Outcome checked = check_values(query); checked.status != Status::applied)
    return refuse_query(query, checked.status, std::move(checked.detail));
  try {
    const std::vector<Hit> hits = find_hits(world, query);
    const std::size_t room = rows_that_fit(payload_limit, kBytesPerHit, answer);
    answer.num_hits = static_cast<std::int32_t>(hits.size());
    for (std::size_t i = 0; i < std::min(hits.size(), room); ++i) push_hit(hits[i], answer);
    return answer;
  } catch (const std::invalid_argument& reason) {
    return refuse_query(query, Status::invalid, reason.what());
  }
}

}  // namespace tumble
