// How exact contacts of curved shapes are: every pair type against the exhaustive search of
// tests/unit/collision/curved_reference.h. Prints a table; ends with 1 if a contact is wrong.
//   contacts_accuracy_curved [SHARE of 100 000 queries a pair of types, 1 [PAIR, e.g. box-cone]]
// wrong: missed, or separating less than the best direction by more than 1e-9 of the shapes' size. The normal's error is
// taken from the optimum next to it, found from gradients in 80 bits (DirectionReference::polish).
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <string>

#include "collision/narrow_phase.h"
#include "unit/collision/curved_reference.h"
#include "unit/collision/sample_shapes.h"

namespace {

using namespace tumble;
using namespace tumble::test;

struct Kind {
  const char* name;
  double least;  ///< Smallest size of a shape, the largest is 1 [m].
  double unit;   ///< [m] instead of 1 m
  bool deep, aligned;
};
constexpr Kind kKinds[] = {{"shallow", 0.2, 1.0, false, false},      {"deep", 0.2, 1.0, true, false},
                           {"aligned", 0.2, 1.0, false, true},       {"aligned deep", 0.2, 1.0, true, true},
                           {"1:1000", 1e-3, 1.0, false, false},      {"1:1000 deep", 1e-3, 1.0, true, false},
                           {"millimetres", 0.2, 1e-3, false, false}, {"kilometres", 0.2, 1e3, true, false}};
constexpr const char* kNames[] = {"sphere", "capsule", "box", "hull", "cylinder", "cone", "ellipsoid"};

Pose make_pose(RandomPose& random, const Shape& a, const Shape& b, const Kind& kind) {
  Quat q = random.rotation();
  Vec3 d = random.direction();
  const double size = bounding_radius(a) + bounding_radius(b);
  const double depth = size * random.log_uniform(1e-6, 2e-2), share = random.uniform(0.0, 1.0);
  if (kind.aligned) {
    const int axis = static_cast<int>(random.uniform(0.0, 3.0)),
              quarters = static_cast<int>(random.uniform(0.0, 4.0));
    q = turn(Vec3::Unit(axis), 1.5707963267948966 * quarters);
    d = Vec3::Unit(static_cast<int>(random.uniform(0.0, 3.0)));
  }
  const Vec3 touching = support(a, d) - q * support(b, q.conjugate() * -d);
  return {q, kind.deep ? Vec3(share * touching) : Vec3(touching - depth * d)};
}

struct Row {
  int wrong = 0;
  double depth_error = 0.0, normal_error = 0.0;
};

Row run(int type_a, int type_b, const Kind& kind, int poses) {
  RandomPose random(static_cast<unsigned>(1000 + 10 * type_a + type_b));
  NarrowPhaseCounters counters;
  Row row;
  for (int i = 0; i < poses; ++i) {
    const Shape a = random_shape(random, type_a, kind.least, kind.unit);
    const Shape b = random_shape(random, type_b, kind.least, kind.unit);
    const Pose X_AB = make_pose(random, a, b, kind);
    const double size = bounding_radius(a) + bounding_radius(b);
    PairCache cache;
    const double margin = 0.1 * size;
    const Manifold m = collide(a, {}, b, X_AB, margin, {}, cache, counters);
    const DirectionReference reference(a, b, X_AB);
    const auto best = reference.search(kind.least < 0.1 ? 3000 : 1200, 6);
    if (m.count == 0) {
      if (static_cast<double>(best.separation) <= margin) ++row.wrong;
      continue;
    }
    double found = std::numeric_limits<double>::infinity();
    for (int k = 0; k < m.count; ++k)
      found = std::min(found, m.points[static_cast<std::size_t>(k)].separation);
    const auto promised = static_cast<double>(reference.separation(m.normal_A));
    const double error =
        std::max(std::abs(found - promised), static_cast<double>(best.separation) - promised) / size;
    if (error > row.depth_error) row.depth_error = error;
    if (error > 1e-9) ++row.wrong;
    const auto polished = reference.polish(m.normal_A);
    if (polished.separation - reference.separation(m.normal_A) > 1e-12L * size) continue;
    const double angle = static_cast<double>((polished.normal_A - m.normal_A.cast<long double>()).norm());
    if (angle < 1e-3 && angle > row.normal_error) row.normal_error = angle;
  }
  return row;
}

}  // namespace

int main(int argc, char** argv) {
  const double share = argc > 1 ? std::atof(argv[1]) : 1.0;
  if (!(share > 0.0)) return std::fprintf(stderr, "contacts_accuracy_curved: the share must be > 0\n"), 2;
  const int poses = std::max(10, static_cast<int>(share * 100000.0 / static_cast<double>(std::size(kKinds))));
  bool good = true;
  std::printf(
      "| pair | kind | queries | wrong | depth error / size | normal error [rad] "
      "|\n|---|---|---|---|---|---|\n");
  for (int b = 4; b < 7; ++b) {
    for (int a = 0; a <= b; ++a) {
      const std::string pair = std::string(kNames[a]) + "-" + kNames[b];
      if (argc > 2 && pair != argv[2]) continue;
      for (const Kind& kind : kKinds) {
        const Row row = run(a, b, kind, poses);
        good = good && row.wrong == 0;
        std::printf("| %s | %s | %d | %d | %.1e | %.1e |\n", pair.c_str(), kind.name, poses, row.wrong,
                    row.depth_error, row.normal_error);
        std::fflush(stdout);
      }
    }
  }
  return good ? 0 : 1;
}
