// See command_check.h.
#include "net/command_check.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <span>

#include "tumble/catalog_t.hpp"

namespace tumble {
namespace {

/// Collects the first field that is out of its range.
class RangeCheck {
 public:
  RangeCheck& within(const char* field, double value, double low, double high) {
    if (failed_ || (value >= low && value <= high)) return *this;
    return fail(fmt::format("{}: {} is not in {} .. {}", field, value, low, high));
  }
  RangeCheck& within(const char* field, std::span<const double> values, double low, double high) {
    for (const double value : values) within(field, value, low, high);
    return *this;
  }
  RangeCheck& demand(bool good, const std::string& text) { return failed_ || good ? *this : fail(text); }
  bool failed() const { return failed_.has_value(); }
  Outcome outcome() const {
    return failed_ ? Outcome{.status = Status::out_of_range, .detail = *failed_} : Outcome{};
  }

 private:
  RangeCheck& fail(const std::string& text) {
    failed_ = text;
    return *this;
  }
  std::optional<std::string> failed_;
};

Outcome refuse_not_finite(const char* field) {
  return {.status = Status::not_finite,
          .detail = fmt::format("{}: {}", field, status_text(Status::not_finite))};
}

void check_motion(const control_t& c, RangeCheck& check) {
  const std::span q(c.orientation);
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  check.within("position", c.position, -kMaxPosition, kMaxPosition)
      .within("orientation's length", length, 1.0 - 1e-3, 1.0 + 1e-3)
      .within("velocity", c.velocity, -kMaxVelocity, kMaxVelocity)
      .within("angular_velocity", c.angular_velocity, -kMaxAngularVelocity, kMaxAngularVelocity);
}

void check_spawn(const control_t& c, RangeCheck& check) {
  check.within("body_type", c.body_type, catalog_t::TYPE_STATIC, catalog_t::TYPE_KINEMATIC)
      .within("shape_type", c.shape_type, catalog_t::SHAPE_HALF_SPACE, catalog_t::SHAPE_ELLIPSOID)
      .demand(c.shape_type != catalog_t::SHAPE_HULL, "shape_type: a hull can't be spawned")
      .demand(c.shape_type != catalog_t::SHAPE_HALF_SPACE || c.body_type == catalog_t::TYPE_STATIC,
              "shape_type: only a static body can be a half-space");
  const int sizes[] = {0, 1, 2, 3, 0, 2, 2, 3};  // numbers of `size` that each shape reads, by SHAPE_*
  for (int i = 0; !check.failed() && i < sizes[c.shape_type]; ++i) {
    check.within("size", c.size[i], kMinSize, kMaxSize);
  }
  if (c.mass != 0.0) check.within("mass", c.mass, kMinMass, kMaxMass);
  check_motion(c, check);
  check.within("friction", c.friction, 0.0, kMaxFriction).within("restitution", c.restitution, 0.0, 1.0);
  for (const float value : c.color) check.within("color", value, 0.0, 1.0);
}

}  // namespace

Outcome check_values(const force_command_t& c) {
  if (const char* field = find_not_finite(c)) return refuse_not_finite(field);
  return RangeCheck()
      .within("frame", c.frame, force_command_t::FRAME_WORLD, force_command_t::FRAME_BODY)
      .within("force", c.force, -kMaxForce, kMaxForce)
      .within("torque", c.torque, -kMaxTorque, kMaxTorque)
      .within("point", c.point, -kMaxPoint, kMaxPoint)
      .within("duration", c.duration, 0.0, kMaxDuration)
      .outcome();
}

Outcome check_values(const query_t& query) {
  const char* field = find_not_finite(query);
  return field ? refuse_not_finite(field) : Outcome{};
}

Outcome check_values(const control_t& c) {
  if (c.verb < control_t::VERB_SPAWN || c.verb > control_t::VERB_PUSHES_OFF) {
    return {.status = Status::unknown_verb, .detail = fmt::format("verb: {} is not known", c.verb)};
  }
  if (const char* field = find_not_finite(c)) return refuse_not_finite(field);
  RangeCheck check;
  if (c.verb == control_t::VERB_SPAWN) check_spawn(c, check);
  if (c.verb == control_t::VERB_SET_STATE) check_motion(c, check);
  if (c.verb == control_t::VERB_SNAPSHOT || c.verb == control_t::VERB_RESTORE) {
    check.demand(!c.name.empty(), "name: a snapshot needs one");
  }
  if (c.verb == control_t::VERB_STEP) {
    check.demand(c.count >= 1 && c.count <= kMaxStepCount,
                 fmt::format("count: {} is not in 1 .. {}", c.count, kMaxStepCount));
  }
  return check.outcome();
}

}  // namespace tumble
