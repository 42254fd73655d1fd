// What one query of the narrow phase costs, beside plain libccd's penetration queries and, for boxes, Bullet's and ODE's
// box-box functions on the same pairs, all in double precision. 512 poses a class; "cold" forgets the pair before each
// query, "warm" keeps each pair's memory while nothing moves, "coherent" while B moves a little with every query.
#include <BulletCollision/CollisionDispatch/btBoxBoxDetector.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <benchmark/benchmark.h>
#include <ccd/ccd.h>
#include <ode/ode.h>

#include <array>
#include <random>
#include <string>
#include <vector>

#include "collision/narrow_phase.h"
#include "math/rotation.h"

namespace {

using namespace tumble;

struct Pair {
  Shape a, b;
  Pose X_WA, X_WB;
};

class Source {
 public:
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
  }
  Vec3 vector(double low, double high) {
    Vec3 v;
    for (int i = 0; i < 3; ++i) v[i] = uniform(low, high);
    return v;
  }
  Quat rotation() {
    Quat q;
    for (int i = 0; i < 4; ++i) q.coeffs()[i] = uniform(-1.0, 1.0);
    return normalized(q);
  }

 private:
  std::mt19937 engine_{1};
};

/// B rests on A's top, turned by q, sunk in by depth [m].
Pair rest_on_top(Source& source, const Shape& a, double top, const Shape& b, const Quat& q, double depth) {
  const double height = -(q * support(b, q.conjugate() * -Vec3::UnitZ())).z();
  const Pose X_WA{source.rotation(), source.vector(-10.0, 10.0)};
  return {a, b, X_WA, X_WA * Pose{q, Vec3(0.1, 0.05, top + height - depth)}};
}

Pair box_face(Source& source) {
  const Box a{source.vector(0.3, 1.0)}, b{source.vector(0.3, 1.0)};
  const double yaw = source.uniform(-1.0, 1.0);
  return rest_on_top(source, a, a.half_extents.z(), b, exp_map(Vec3(0, 0, yaw)), 1e-4);
}

Pair box_edge(Source& source) {
  const Box a{source.vector(0.3, 1.0)}, b{source.vector(0.3, 1.0)};
  const double roll_a = source.uniform(0.5, 1.0), roll_b = source.uniform(0.5, 1.0),
               yaw = source.uniform(0.4, 2.7);
  const Quat q_A = exp_map(Vec3(roll_a, 0, 0)), q_B = exp_map(Vec3(0, 0, yaw)) * exp_map(Vec3(roll_b, 0, 0));
  const Vec3 roof = q_A * Vec3(0, a.half_extents.y(), a.half_extents.z());
  const Vec3 floor = q_B * Vec3(0, -b.half_extents.y(), -b.half_extents.z());
  const Pose X_W{source.rotation(), source.vector(-10.0, 10.0)};
  return {a, b, X_W * Pose{q_A, -roof}, X_W * Pose{q_B, -floor - Vec3(0, 0, 1e-4)}};
}

Pair box_deep(Source& source) {
  const Box a{source.vector(0.3, 1.0)}, b{source.vector(0.3, 1.0)};
  const Pose X_WA{source.rotation(), source.vector(-10.0, 10.0)};
  const Pose X_AB{source.rotation(), source.vector(-0.4, 0.4)};
  return {a, b, X_WA, X_WA * X_AB};
}

Pair sphere_sphere(Source& source) {
  const Pose X_WA{Quat::Identity(), source.vector(-10.0, 10.0)};
  const Vec3 d = source.vector(-1.0, 1.0).normalized();
  return {Sphere{0.5}, Sphere{0.4}, X_WA, {Quat::Identity(), X_WA.p + 0.8999 * d}};
}

/// 32 random points on a sphere of radius 0.5.
HullPointer hull32(Source& source) {
  std::vector<Vec3> points;
  for (int i = 0; i < 32; ++i) points.push_back(0.5 * source.vector(-1.0, 1.0).normalized());
  return std::make_shared<const ConvexHull>(build_convex_hull(points));
}

Pair hull_pair(Source& source, double depth) {
  static const HullPointer hull = hull32(source);
  const Quat q = source.rotation();
  const Vec3 n = source.vector(-1.0, 1.0).normalized();
  const Vec3 p = support(hull, n) - q * support(hull, q.conjugate() * -n) - depth * n;
  const Pose X_WA{source.rotation(), source.vector(-10.0, 10.0)};
  return {hull, hull, X_WA, X_WA * Pose{q, p}};
}
Pair hull_shallow(Source& source) {
  return hull_pair(source, 1e-3);
}
Pair hull_deep(Source& source) {
  return hull_pair(source, 0.1);
}

/// A vertex of B lies in the middle of a face of A, 0.1 mm deep.
Pair hull_rest(Source& source) {
  static const HullPointer hull = hull32(source);
  const ConvexHull::Face& face = hull->faces[static_cast<std::size_t>(source.uniform(0.0, 20.0))];
  Vec3 middle = Vec3::Zero();
  for (std::uint32_t k = 0; k < face.count; ++k)
    middle += hull->vertices[hull->loops[face.first + k]] / face.count;
  const Quat q = source.rotation();
  const Vec3 p = middle - q * support(hull, q.conjugate() * -face.normal) - 1e-4 * face.normal;
  const Pose X_WA{source.rotation(), source.vector(-10.0, 10.0)};
  return {hull, hull, X_WA, X_WA * Pose{q, p}};
}
/// About as often apart as not.
Pair hull_pass(Source& source) {
  return hull_pair(source, source.uniform(-0.05, 0.02));
}

/// Two shapes that touch along a random direction, and `depth` [m] of overlap.
Pair touching(Source& source, const Shape& a, const Shape& b, double depth) {
  const Quat q = source.rotation();
  const Vec3 n = source.vector(-1.0, 1.0).normalized();
  const Vec3 p = support(a, n) - q * support(b, q.conjugate() * -n) - depth * n;
  const Pose X_WA{source.rotation(), source.vector(-10.0, 10.0)};
  return {a, b, X_WA, X_WA * Pose{q, p}};
}
const Box kBox{Vec3(0.5, 0.4, 0.3)};
const Cylinder kCylinder{0.4, 0.5};
const Cone kCone{0.4, 0.5};
const Ellipsoid kEllipsoid{Vec3(0.5, 0.4, 0.3)};

Pair cylinder_on_box(Source& source) {
  return rest_on_top(source, Box{Vec3(1.0, 1.0, 0.5)}, 0.5, kCylinder, Quat::Identity(), 1e-4);
}
Pair box_cylinder(Source& source) {
  return touching(source, kBox, kCylinder, 1e-3);
}
Pair box_cylinder_deep(Source& source) {
  return touching(source, kBox, kCylinder, 0.1);
}
Pair cylinder_cylinder(Source& source) {
  return touching(source, kCylinder, kCylinder, 1e-3);
}
Pair cone_cylinder(Source& source) {
  return touching(source, kCone, kCylinder, 1e-3);
}
Pair ellipsoid_ellipsoid(Source& source) {
  return touching(source, kEllipsoid, kEllipsoid, 1e-3);
}
Pair ellipsoid_ellipsoid_deep(Source& source) {
  return touching(source, kEllipsoid, kEllipsoid, 0.1);
}
Pair sphere_ellipsoid(Source& source) {
  return touching(source, Sphere{0.4}, kEllipsoid, 1e-3);
}

using Make = Pair (*)(Source&);

std::vector<Pair> make_pairs(Make make) {
  Source source;
  std::vector<Pair> pairs;
  for (int i = 0; i < 512; ++i) pairs.push_back(make(source));
  return pairs;
}

void tumble_contacts(benchmark::State& state, Make make, bool keep_memory) {
  const std::vector<Pair> pairs = make_pairs(make);
  std::vector<PairCache> caches(pairs.size());
  NarrowPhaseCounters counters;
  std::size_t i = 0;
  std::uint64_t points = 0;
  for (auto _ : state) {
    const Pair& pair = pairs[i];
    PairCache cold;
    const Manifold m =
        collide(pair.a, pair.X_WA, pair.b, pair.X_WB, 0.0, {}, keep_memory ? caches[i] : cold, counters);
    points += static_cast<std::uint64_t>(m.count);
    benchmark::DoNotOptimize(m.normal_A);
    i = (i + 1) % pairs.size();
  }
  state.counters["points"] = static_cast<double>(points) / static_cast<double>(state.iterations());
}

/// B wanders: each query has moved it by about `pace` [m] and [rad], to and fro along one direction for 64 queries each.
void tumble_coherent(benchmark::State& state, Make make, double pace) {
  constexpr std::size_t kSteps = 64;
  const std::vector<Pair> pairs = make_pairs(make);
  std::vector<std::vector<Pose>> paths;
  Source source;
  for (const Pair& pair : pairs) {
    const Vec3 shift = source.vector(-pace, pace);
    const Quat turn = exp_map(source.vector(-pace, pace));
    std::vector<Pose> path = {pair.X_WB};
    while (path.size() < kSteps) path.push_back({normalized(turn * path.back().q), path.back().p + shift});
    for (std::size_t i = kSteps; i-- > 0;) path.push_back(path[i]);
    paths.push_back(path);
  }
  std::vector<PairCache> caches(pairs.size());
  NarrowPhaseCounters counters;
  std::size_t i = 0, step = 0;
  for (auto _ : state) {
    const Pair& pair = pairs[i];
    const Manifold m = collide(pair.a, pair.X_WA, pair.b, paths[i][step], 0.0, {}, caches[i], counters);
    benchmark::DoNotOptimize(m.normal_A);
    if (++i == pairs.size()) i = 0, step = (step + 1) % (2 * kSteps);
  }
  const double queries = static_cast<double>(counters.queries);
  state.counters["by_motion"] = static_cast<double>(counters.motion_bound) / queries;
  state.counters["by_axis"] = static_cast<double>(counters.cached_axis) / queries;
  state.counters["by_gjk"] = static_cast<double>(counters.gjk) / queries;
  state.counters["exact"] = static_cast<double>(counters.exact) / queries;
  state.counters["facet_kept"] = static_cast<double>(counters.facet_kept) / queries;
}

struct BulletPoints : btDiscreteCollisionDetectorInterface::Result {
  void setShapeIdentifiersA(int, int) override {}
  void setShapeIdentifiersB(int, int) override {}
  void addContactPoint(const btVector3&, const btVector3&, btScalar) override { ++count; }
  std::uint64_t count = 0;
};

btTransform to_bullet(const Pose& X) {
  return btTransform(btQuaternion(X.q.x(), X.q.y(), X.q.z(), X.q.w()), btVector3(X.p.x(), X.p.y(), X.p.z()));
}

void bullet_boxes(benchmark::State& state, Make make) {
  const std::vector<Pair> pairs = make_pairs(make);
  std::vector<btBoxShape> a, b;
  std::vector<btDiscreteCollisionDetectorInterface::ClosestPointInput> inputs;
  for (const Pair& pair : pairs) {
    const Vec3 &ha = std::get_if<Box>(&pair.a)->half_extents, &hb = std::get_if<Box>(&pair.b)->half_extents;
    a.emplace_back(btVector3(ha.x(), ha.y(), ha.z()));
    b.emplace_back(btVector3(hb.x(), hb.y(), hb.z()));
    inputs.emplace_back();
    inputs.back().m_transformA = to_bullet(pair.X_WA);
    inputs.back().m_transformB = to_bullet(pair.X_WB);
  }
  BulletPoints points;
  std::size_t i = 0;
  for (auto _ : state) {
    btBoxBoxDetector detector(&a[i], &b[i]);
    detector.getClosestPoints(inputs[i], points, nullptr);
    benchmark::DoNotOptimize(points.count);
    i = (i + 1) % pairs.size();
  }
  state.counters["points"] = static_cast<double>(points.count) / static_cast<double>(state.iterations());
}

struct OdeBox {
  dVector3 position, side;
  dMatrix3 rotation;
};

OdeBox to_ode(const Shape& shape, const Pose& X) {
  OdeBox box{};
  const Mat3 R = rotation_matrix(X.q);
  for (int i = 0; i < 3; ++i) {
    box.position[i] = X.p[i];
    box.side[i] = 2.0 * std::get_if<Box>(&shape)->half_extents[i];
    for (int j = 0; j < 3; ++j) box.rotation[4 * i + j] = R(i, j);
  }
  return box;
}

void ode_boxes(benchmark::State& state, Make make) {
  std::vector<OdeBox> a, b;
  for (const Pair& pair : make_pairs(make)) {
    a.push_back(to_ode(pair.a, pair.X_WA));
    b.push_back(to_ode(pair.b, pair.X_WB));
  }
  std::array<dContactGeom, 8> contacts;
  std::size_t i = 0;
  std::uint64_t points = 0;
  for (auto _ : state) {
    dVector3 normal;
    dReal depth = 0;
    int axis = 0;
    points += static_cast<std::uint64_t>(dBoxBox(a[i].position, a[i].rotation, a[i].side, b[i].position,
                                                 b[i].rotation, b[i].side, normal, &depth, &axis, 8,
                                                 contacts.data(), sizeof(dContactGeom)));
    benchmark::DoNotOptimize(contacts);
    i = (i + 1) % a.size();
  }
  state.counters["points"] = static_cast<double>(points) / static_cast<double>(state.iterations());
}

struct PlacedShape {
  const Shape* shape;
  Mat3 R;
  Vec3 p;
};

void ccd_support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const PlacedShape& placed = *static_cast<const PlacedShape*>(object);
  const Vec3 d(direction->v[0], direction->v[1], direction->v[2]);
  const Vec3 v = placed.R * support(*placed.shape, placed.R.transpose() * d) + placed.p;
  ccdVec3Set(out, v.x(), v.y(), v.z());
}
void ccd_centre(const void* object, ccd_vec3_t* out) {
  const Vec3& p = static_cast<const PlacedShape*>(object)->p;
  ccdVec3Set(out, p.x(), p.y(), p.z());
}

/// Default tolerances; the iteration limit keeps touching pairs from cycling for ever.
void plain_libccd(benchmark::State& state, Make make, bool mpr) {
  const std::vector<Pair> pairs = make_pairs(make);
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = ccd_support;
  ccd.center1 = ccd.center2 = ccd_centre;
  ccd.max_iterations = 500;
  std::size_t i = 0;
  for (auto _ : state) {
    const Pair& pair = pairs[i];
    const PlacedShape a{&pair.a, rotation_matrix(pair.X_WA.q), pair.X_WA.p};
    const PlacedShape b{&pair.b, rotation_matrix(pair.X_WB.q), pair.X_WB.p};
    ccd_real_t depth = 0;
    ccd_vec3_t normal, position;
    benchmark::DoNotOptimize(mpr ? ccdMPRPenetration(&a, &b, &ccd, &depth, &normal, &position)
                                 : ccdGJKPenetration(&a, &b, &ccd, &depth, &normal, &position));
    benchmark::DoNotOptimize(depth);
    i = (i + 1) % pairs.size();
  }
}

void add_class(const std::string& name, Make make, bool boxes = false) {
  benchmark::RegisterBenchmark((name + "/tumble_cold").c_str(), tumble_contacts, make, false);
  benchmark::RegisterBenchmark((name + "/tumble_warm").c_str(), tumble_contacts, make, true);
  benchmark::RegisterBenchmark((name + "/ccdGJKPenetration").c_str(), plain_libccd, make, false);
  benchmark::RegisterBenchmark((name + "/ccdMPRPenetration").c_str(), plain_libccd, make, true);
  if (!boxes) return;
  benchmark::RegisterBenchmark((name + "/bullet").c_str(), bullet_boxes, make);
  benchmark::RegisterBenchmark((name + "/ode").c_str(), ode_boxes, make);
}

}  // namespace

int main(int argc, char** argv) {
  add_class("box_face", box_face, true);
  add_class("box_edge", box_edge, true);
  add_class("box_deep", box_deep, true);
  add_class("sphere_sphere", sphere_sphere);
  add_class("hull32_shallow", hull_shallow);
  add_class("hull32_deep", hull_deep);
  benchmark::RegisterBenchmark("box_resting/tumble_coherent", tumble_coherent, box_face, 1e-6);
  benchmark::RegisterBenchmark("hull32_resting/tumble_coherent", tumble_coherent, hull_rest, 1e-7);
  benchmark::RegisterBenchmark("hull32_moving/tumble_coherent", tumble_coherent, hull_pass, 2e-3);
  add_class("cylinder_on_box", cylinder_on_box);
  add_class("box_cylinder", box_cylinder);
  add_class("box_cylinder_deep", box_cylinder_deep);
  add_class("cylinder_cylinder", cylinder_cylinder);
  add_class("cone_cylinder", cone_cylinder);
  add_class("ellipsoid_ellipsoid", ellipsoid_ellipsoid);
  add_class("ellipsoid_ellipsoid_deep", ellipsoid_ellipsoid_deep);
  add_class("sphere_ellipsoid", sphere_ellipsoid);
  benchmark::RegisterBenchmark("cylinder_resting/tumble_coherent", tumble_coherent, cylinder_on_box, 1e-6);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
