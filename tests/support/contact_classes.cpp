// The classes of pairs that contacts are judged on: boxes in the twelve classes where libccd fails, hulls with many
// vertices and hulls as people design them, and rounded shapes with everything.
#include <array>

#include "math/rotation.h"
#include "support/contact_accuracy.h"

namespace tumble::test {
namespace {

/// B turned by q_AB, pushed along the direction n_A until it overlaps A by depth [m] (or is that far away).
PlacedPair push_together(RandomPose& random, const Shape& a, const Shape& b, const Quat& q_AB,
                         const Vec3& n_A, double depth, const Vec3& aside_A = Vec3::Zero()) {
  const Vec3 top = std::holds_alternative<HalfSpace>(a) ? Vec3(Vec3::Zero()) : support(a, n_A);
  const Vec3 bottom = q_AB * support(b, q_AB.conjugate() * -n_A);
  const Vec3 p = top - bottom - depth * n_A + aside_A;
  const Pose X_WA = random.pose(10.0);
  return {a, b, X_WA, X_WA * Pose{q_AB, p}};
}

Box random_box(RandomPose& random, double scale = 1.0) {
  return {scale * random.vector(0.3, 1.0)};
}

/// B's lowest part along A's +z touches A's top at a random place and sinks in by depth.
PlacedPair rest_on_top(RandomPose& random, double scale_a, double scale_b, const Quat& q_AB, double depth) {
  const Box a = random_box(random, scale_a), b = random_box(random, scale_b);
  const double height = rotation_matrix(q_AB).row(2).cwiseAbs().dot(b.half_extents.transpose());
  const double x = random.uniform(-0.6, 0.6), y = random.uniform(-0.6, 0.6);
  const Vec3 p(x * a.half_extents.x(), y * a.half_extents.y(), a.half_extents.z() + height - depth);
  const Pose X_WA = random.pose(10.0);
  return {a, b, X_WA, X_WA * Pose{q_AB, p}};
}

PlacedPair face_on_face(RandomPose& random, double tilt, double scale = 1.0) {
  const double yaw = random.uniform(-3.0, 3.0), depth = scale * random.log_uniform(1e-6, 1e-2);
  const Vec3 axis = random.direction();
  return rest_on_top(random, scale, scale, turn(axis, tilt) * turn(Vec3::UnitZ(), yaw), depth);
}

PlacedPair boxes_anyhow(RandomPose& random, double reach) {
  const Box a = random_box(random), b = random_box(random);
  const Pose X_WA = random.pose(10.0), X_AB = random.pose(reach);
  return {a, b, X_WA, X_WA * X_AB};
}

PlacedPair aligned_stack(RandomPose& random) {
  const Box box = random_box(random);
  const double depth = random.log_uniform(1e-6, 1e-2);
  const Vec3 p = random.vector(-10.0, 10.0);
  return {box,
          box,
          {Quat::Identity(), p},
          {Quat::Identity(), p + Vec3(0, 0, 2.0 * box.half_extents.z() - depth)}};
}

/// Two roofs, each an edge of its box turned by about 45 degrees, the ridges turned against each other by yaw [rad].
PlacedPair edge_on_edge(RandomPose& random, double yaw) {
  const Box a = random_box(random), b = random_box(random);
  const double roll_a = random.uniform(0.5, 1.0), roll_b = random.uniform(0.5, 1.0);
  const double depth = random.log_uniform(1e-6, 1e-2);
  const Quat q_A = turn(Vec3::UnitX(), roll_a), q_B = turn(Vec3::UnitZ(), yaw) * turn(Vec3::UnitX(), roll_b);
  const Vec3 roof = q_A * Vec3(0, a.half_extents.y(), a.half_extents.z());
  const Vec3 floor = q_B * Vec3(0, -b.half_extents.y(), -b.half_extents.z());
  const Pose X_W = random.pose(10.0);
  return {a, b, X_W * Pose{q_A, -roof}, X_W * Pose{q_B, -floor - Vec3(0, 0, depth)}};
}

PlacedPair vertex_on_face(RandomPose& random, double scale_a, double deepest) {
  const Quat q_AB = random.rotation();
  const double depth = deepest > 0.0 ? random.log_uniform(1e-6, deepest) : 0.0;
  return rest_on_top(random, scale_a, 1.0, q_AB, depth);
}

/// Hulls of one kind, built once.
class HullPool {
 public:
  HullPool(int count, HullPointer (*make)(RandomPose&)) {
    RandomPose random(7);
    for (int i = 0; i < count; ++i) hulls_.push_back(make(random));
  }
  const HullPointer& any(RandomPose& random) const {
    const double pick = random.uniform(0.0, static_cast<double>(hulls_.size()));
    return hulls_[std::min(static_cast<std::size_t>(pick), hulls_.size() - 1)];
  }

 private:
  std::vector<HullPointer> hulls_;
};

HullPointer hull_of(const std::vector<Vec3>& points) {
  return std::make_shared<const ConvexHull>(build_convex_hull(points));
}

template <int kPoints>
HullPointer rock(RandomPose& random) {
  const Vec3 radii = random.vector(0.3, 1.0);
  std::vector<Vec3> points;
  for (int i = 0; i < kPoints; ++i) points.push_back(random.direction().cwiseProduct(radii));
  return hull_of(points);
}

HullPointer prism(RandomPose& random, int sides, double radius, double height) {
  const double phase = random.uniform(0.0, 1.0);
  std::vector<Vec3> points;
  for (int i = 0; i < sides; ++i) {
    const double angle = phase + 2.0 * M_PI * i / sides;
    for (const double z : {-height, height})
      points.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
  }
  return hull_of(points);
}

HullPointer chamfered_box(RandomPose& random) {
  const Vec3 h = random.vector(0.3, 1.0);
  const double chamfer = random.uniform(0.02, 0.2) * h.minCoeff();
  std::vector<Vec3> points;
  for (int corner = 0; corner < 8; ++corner) {
    for (int k = 0; k < 3; ++k) {
      Vec3 p;
      for (int i = 0; i < 3; ++i) p[i] = (corner >> i & 1 ? 1.0 : -1.0) * (i == k ? h[i] : h[i] - chamfer);
      points.push_back(p);
    }
  }
  return hull_of(points);
}

HullPointer wedge(RandomPose& random) {
  const Vec3 h = random.vector(0.3, 1.0);
  return hull_of({{-h.x(), -h.y(), 0},
                  {h.x(), -h.y(), 0},
                  {-h.x(), h.y(), 0},
                  {h.x(), h.y(), 0},
                  {-h.x(), h.y(), h.z()},
                  {h.x(), h.y(), h.z()}});
}

/// Designed parts: large flat faces, many thin ones, and slivers 1 : 1000.
HullPointer part(RandomPose& random) {
  switch (static_cast<int>(random.uniform(0.0, 4.999))) {
    case 0:
      return chamfered_box(random);
    case 1:
      return prism(random, 24, random.uniform(0.3, 1.0), random.uniform(0.2, 1.0));
    case 2:
      return wedge(random);
    case 3:
      return prism(random, 5, random.uniform(0.3, 1.0), 1e-3);
    default:
      return prism(random, 3, 1e-3, random.uniform(0.3, 1.0));
  }
}

const HullPool& rocks32() {
  static const HullPool pool(32, rock<32>);
  return pool;
}
const HullPool& rocks200() {
  static const HullPool pool(8, rock<200>);
  return pool;
}
const HullPool& parts() {
  static const HullPool pool(64, part);
  return pool;
}

double radius_of(const Shape& shape) {
  return std::holds_alternative<HalfSpace>(shape) ? 1.0 : bounding_radius(shape);
}

PlacedPair shallow(RandomPose& random, const Shape& a, const Shape& b) {
  const Vec3 n = std::holds_alternative<HalfSpace>(a) ? Vec3(Vec3::UnitZ()) : random.direction();
  const Quat q = random.rotation();
  const double depth = random.log_uniform(1e-6, 2e-2) * std::min(radius_of(a), radius_of(b));
  return push_together(random, a, b, q, n, depth);
}

PlacedPair deep(RandomPose& random, const Shape& a, const Shape& b) {
  const double reach = std::holds_alternative<HalfSpace>(a) ? 0.5 : 0.3 * (radius_of(a) + radius_of(b));
  const Pose X_WA = random.pose(10.0), X_AB = random.pose(reach);
  return {a, b, X_WA, X_WA * X_AB};
}

Vec3 pick_normal(RandomPose& random, const ConvexHull& hull) {
  const double at = random.uniform(0.0, static_cast<double>(hull.faces.size()));
  return hull.faces[std::min(static_cast<std::size_t>(at), hull.faces.size() - 1)].normal;
}

/// Some face of B lies on some face of A, tilted by 0 to 1e-3 rad.
PlacedPair face_to_face(RandomPose& random, const HullPointer& a, const HullPointer& b) {
  const Vec3 n_A = pick_normal(random, *a), n_B = pick_normal(random, *b);
  constexpr std::array<double, 4> tilts = {0.0, 1e-9, 1e-6, 1e-3};
  const double tilt = tilts[static_cast<std::size_t>(random.uniform(0.0, 3.999))];
  const Vec3 axis = random.direction(), aside = 0.2 * random.direction();
  const double depth = random.log_uniform(1e-6, 1e-2) * std::min(a->radius, b->radius);
  const Quat q = turn(axis, tilt) * rotation_to_normal(-n_A) * rotation_to_normal(n_B).conjugate();
  return push_together(random, a, b, normalized(q), n_A, depth, aside - aside.dot(n_A) * n_A);
}

Shape rounded(RandomPose& random, int kind) {
  const double radius = random.uniform(0.1, 1.0), half_length = random.uniform(0.1, 1.0);
  return kind == 0 ? Shape(Sphere{radius}) : Shape(Capsule{radius, half_length});
}

Shape any_shape(RandomPose& random, int kind) {
  switch (kind) {
    case 0:
      return HalfSpace{};
    case 1:
      return rounded(random, 0);
    case 2:
      return rounded(random, 1);
    case 3:
      return random_box(random);
    default:
      return random.uniform(0.0, 1.0) < 0.5 ? rocks32().any(random) : parts().any(random);
  }
}

/// A gap of 1e-6 to 2e-2 along some direction, and a margin that sees it.
PlacedPair near_miss(RandomPose& random, const Shape& a, const Shape& b) {
  const Vec3 n = random.direction();
  const Quat q = random.rotation();
  const double gap = random.log_uniform(1e-6, 2e-2);
  PlacedPair pair = push_together(random, a, b, q, n, -gap);
  pair.margin = 0.05;
  return pair;
}

/// Two equal bodies lie face to face across a gap, their outlines off by 1e-6 to 1e-3 m and, most of them, tilted by 1e-7
/// to 1e-2 rad: what hangs over the other's edge is not over the face.
PlacedPair hover(RandomPose& random, const Shape& shape, const Vec3& n) {
  const Vec3 aside = random.direction() * random.log_uniform(1e-6, 1e-3);
  const double tilt = random.uniform(0.0, 1.0) < 0.2 ? 0.0 : random.log_uniform(1e-7, 1e-2);
  const double gap = random.log_uniform(1e-6, 2e-2);
  const Quat q = turn(random.direction(), tilt);
  const Vec3 top = support(shape, n), bottom = q * support(shape, q.conjugate() * -n);
  const Vec3 p = (n.dot(top - bottom) + gap) * n + aside - aside.dot(n) * n;
  const Pose X_WA = random.pose(10.0);
  return {shape, shape, X_WA, X_WA * Pose{q, p}, 0.05};
}

template <typename MakeA, typename MakeB>
void add_near_miss(std::vector<ContactClass>& classes, const std::string& pairs, int queries, MakeA make_a,
                   MakeB make_b) {
  classes.push_back({pairs, "apart, within the margin", queries, [=](RandomPose& r) {
                       const Shape a = make_a(r), b = make_b(r);
                       return near_miss(r, a, b);
                     }});
}

template <typename MakeA, typename MakeB>
void add_shallow_and_deep(std::vector<ContactClass>& classes, const std::string& pairs, int queries,
                          MakeA make_a, MakeB make_b) {
  classes.push_back({pairs, "shallow", queries, [=](RandomPose& r) {
                       const Shape a = make_a(r), b = make_b(r);
                       return shallow(r, a, b);
                     }});
  classes.push_back({pairs, "deep", queries, [=](RandomPose& r) {
                       const Shape a = make_a(r), b = make_b(r);
                       return deep(r, a, b);
                     }});
}

void add_boxes(std::vector<ContactClass>& classes) {
  const auto add = [&](const char* name, auto make) { classes.push_back({"box-box", name, 1000000, make}); };
  add("random deep", [](RandomPose& r) { return boxes_anyhow(r, 0.5); });
  add("random any", [](RandomPose& r) { return boxes_anyhow(r, 1.2); });
  add("face-face, tilt 0", [](RandomPose& r) { return face_on_face(r, 0.0); });
  add("face-face, tilt 1e-9", [](RandomPose& r) { return face_on_face(r, 1e-9); });
  add("face-face, tilt 1e-6", [](RandomPose& r) { return face_on_face(r, 1e-6); });
  add("face-face, tilt 1e-3", [](RandomPose& r) { return face_on_face(r, 1e-3); });
  add("aligned stack", aligned_stack);
  add("edge-edge", [](RandomPose& r) { return edge_on_edge(r, r.uniform(0.4, 2.7)); });
  add("nearly parallel edges", [](RandomPose& r) { return edge_on_edge(r, r.log_uniform(1e-12, 1e-2)); });
  add("vertex-face", [](RandomPose& r) { return vertex_on_face(r, 3.0, 1e-2); });
  add("1:1000", [](RandomPose& r) { return vertex_on_face(r, 1000.0, 1e-2); });
  add("millimetres", [](RandomPose& r) { return face_on_face(r, 1e-3, 1e-3); });
  add("kilometres", [](RandomPose& r) { return face_on_face(r, 1e-3, 1e3); });
  add("touching", [](RandomPose& r) { return vertex_on_face(r, 2.0, 0.0); });
}

void add_hulls(std::vector<ContactClass>& classes) {
  const auto rock32 = [](RandomPose& r) -> Shape { return rocks32().any(r); };
  const auto rock200 = [](RandomPose& r) -> Shape { return rocks200().any(r); };
  const auto designed = [](RandomPose& r) -> Shape { return parts().any(r); };
  const auto box = [](RandomPose& r) -> Shape { return random_box(r); };
  add_near_miss(classes, "box-box", 1000000, box, box);
  add_near_miss(classes, "hull-hull, 32 vertices", 1000000, rock32, rock32);
  add_near_miss(classes, "hull-hull, parts", 1000000, designed, designed);
  add_near_miss(classes, "box-hull, 32 vertices", 1000000, box, rock32);
  classes.push_back({"box-box", "lying, apart", 1000000, [](RandomPose& r) {
                       const Box shape = random_box(r);
                       return hover(r, shape, Vec3::Unit(static_cast<int>(r.uniform(0.0, 2.999))));
                     }});
  classes.push_back({"hull-hull, parts", "lying, apart", 1000000, [](RandomPose& r) {
                       const HullPointer hull = parts().any(r);
                       return hover(r, hull, pick_normal(r, *hull));
                     }});
  add_shallow_and_deep(classes, "hull-hull, 32 vertices", 1000000, rock32, rock32);
  add_shallow_and_deep(classes, "hull-hull, 200 vertices", 200000, rock200, rock200);
  add_shallow_and_deep(classes, "hull-hull, parts", 1000000, designed, designed);
  classes.push_back({"hull-hull, parts", "face-face", 1000000, [](RandomPose& r) {
                       const HullPointer a = parts().any(r), b = parts().any(r);
                       return face_to_face(r, a, b);
                     }});
  add_shallow_and_deep(classes, "box-hull, 32 vertices", 1000000, box, rock32);
  add_shallow_and_deep(classes, "box-hull, 200 vertices", 200000, box, rock200);
  add_shallow_and_deep(classes, "box-hull, parts", 1000000, box, designed);
}

void add_rounded(std::vector<ContactClass>& classes) {
  constexpr std::array<const char*, 5> names = {"half-space", "sphere", "capsule", "box", "hull"};
  for (int i = 0; i < 5; ++i) {
    for (int j = std::max(1, i); j < 5; ++j) {
      if (i >= 3) continue;  // boxes and hulls have classes of their own
      const auto make_a = [i](RandomPose& r) { return any_shape(r, i); };
      const auto make_b = [j](RandomPose& r) { return any_shape(r, j); };
      const std::string pairs =
          std::string(names[static_cast<std::size_t>(i)]) + "-" + names[static_cast<std::size_t>(j)];
      add_shallow_and_deep(classes, pairs, 1000000, make_a, make_b);
    }
  }
}

}  // namespace

std::vector<ContactClass> contact_classes() {
  std::vector<ContactClass> classes;
  add_boxes(classes);
  add_hulls(classes);
  add_rounded(classes);
  return classes;
}

}  // namespace tumble::test
