// libccd's GJK behind a certificate. Everything runs in A's frame, scaled so that the bounding radii add up to 1:
// libccd compares squared and quartic lengths with DBL_EPSILON, so overlapping 1 mm cubes are "apart" for it otherwise.
#include "collision/gjk.h"

#include <ccd/ccd.h>

#include "math/rotation.h"

namespace tumble {
namespace {

/// libccd's default is endless, and it does cycle on touching boxes.
constexpr unsigned long kGjkIterations = 64;

/// State of one run, shared by the two callbacks. libccd asks for A along dir, then for B along -dir.
struct Run {
  const Shape& a;
  const Shape& b;
  Mat3 R_AB;
  Vec3 p_AB;
  double scale;  ///< [1/m]
  Vec3 direction_A;
  int calls = 0;
};

Vec3 to_vec3(const ccd_vec3_t* v) {
  return {v->v[0], v->v[1], v->v[2]};
}
void from_vec3(const Vec3& v, ccd_vec3_t* out) {
  ccdVec3Set(out, v.x(), v.y(), v.z());
}

/// True as long as the budget lasts; afterwards the support is the origin, on which every loop of libccd ends.
bool spend_call(Run& run, ccd_vec3_t* out) {
  if (++run.calls <= kGjkCallBudget) return true;
  ccdVec3Set(out, 0, 0, 0);
  return false;
}

void support_a(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  Run& run = *static_cast<Run*>(const_cast<void*>(object));
  if (!spend_call(run, out)) return;
  run.direction_A = to_vec3(direction);
  from_vec3(support(run.a, run.direction_A) * run.scale, out);
}

void support_b(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  Run& run = *static_cast<Run*>(const_cast<void*>(object));
  if (!spend_call(run, out)) return;
  const Vec3 d_B = run.R_AB.transpose() * to_vec3(direction);
  from_vec3((run.R_AB * support(run.b, d_B) + run.p_AB) * run.scale, out);
}

void centre_line(const void* object, const void*, ccd_vec3_t* out) {
  const Run& run = *static_cast<const Run*>(object);
  const Vec3 d = run.p_AB * run.scale;
  from_vec3(d.squaredNorm() > 0.0 ? d : Vec3(0, 0, 1), out);
}

}  // namespace

GjkAnswer decide_apart(const Shape& a, const Shape& b, const Pose& X_AB) {
  const double size = bounding_radius(a) + bounding_radius(b);
  Run run{a, b, rotation_matrix(X_AB.q), X_AB.p, 1.0 / size, X_AB.p};
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.first_dir = centre_line;
  ccd.support1 = support_a;
  ccd.support2 = support_b;
  ccd.max_iterations = kGjkIterations;
  const bool intersect = ccdGJKIntersect(&run, &run, &ccd) != 0;

  GjkAnswer answer{GjkAnswer::Kind::touching, Vec3::UnitZ(), 0.0};
  answer.budget_hit = run.calls > kGjkCallBudget;
  const double length = run.direction_A.stableNorm();
  if (length > 0.0 && std::isfinite(length)) answer.axis_A = run.direction_A / length;
  const double error = kSeparationRounding * (size + X_AB.p.norm());
  answer.gap = separation_along(a, b, run.R_AB, run.p_AB, answer.axis_A) - error;
  if (answer.gap > 0.0) {
    answer.kind = GjkAnswer::Kind::apart;
  } else if (!intersect || answer.budget_hit) {
    answer.kind = GjkAnswer::Kind::undecided;
  }
  return answer;
}

}  // namespace tumble
