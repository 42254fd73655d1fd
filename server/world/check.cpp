// See check.h.
#include "world/check.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace tumble {

void refuse(const std::string& reason) {
  throw std::invalid_argument(reason);
}

void check_finite(const char* field, const Vec3& v) {
  if (!v.allFinite()) refuse(fmt::format("{}: must be finite ({} {} {})", field, v.x(), v.y(), v.z()));
}

void check_pose(const char* position_field, const char* orientation_field, const Pose& pose) {
  check_finite(position_field, pose.p);
  const double norm2 = pose.q.coeffs().squaredNorm();
  if (!(std::abs(norm2 - 1.0) < 1e-6)) {
    refuse(fmt::format("{}: quaternion must have length 1 (squared length {})", orientation_field, norm2));
  }
}

}  // namespace tumble
