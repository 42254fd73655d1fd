// What one query of the narrow phase costs, beside plain libccd's penetration queries and, for boxes, Bullet's and ODE's
// box-box functions on the same pairs, all in double precision, from the pose of B as quaternion and position to the
// contact. 512 pairs a class, one after the other in the same order again and again, which a processor learns by heart;
// with `--shuffled` in an order that never comes back, as in a scene. "cold" forgets the pair before each query; the others
// keep each pair's memory, while nothing moves or, where a pace is given, while B moves a little with every query.
// `--queries=N` runs every benchmark exactly so often: two such runs under callgrind differ by the instructions of the
// queries between them (run_benchmarks.py).
#include <BulletCollision/CollisionDispatch/btBoxBoxDetector.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <benchmark/benchmark.h>
#include <ccd/ccd.h>
#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "collision/collide_sphere.h"
#include "collision/narrow_phase.h"
#include "contact_pairs.h"
#include "math/rotation.h"

namespace {

using namespace tumble;
using namespace tumble::bench;

void tumble_cold(benchmark::State& state, const Course& course) {
  Trace trace(course);
  NarrowPhaseCounters counters;
  std::uint64_t points = 0;
  Manifold manifold;
  for (auto _ : state) {
    const Pair& pair = trace.pair();
    PairCache cold;
    update_manifold(pair.a, pair.X_WA, pair.b, trace.X_WB(), 0.0, {}, cold, counters, manifold, pair.part);
    points += static_cast<std::uint64_t>(manifold.count);
    benchmark::DoNotOptimize(manifold);
    trace.advance();
  }
  state.counters["points"] = static_cast<double>(points) / static_cast<double>(state.iterations());
}

/// What the others spend on going from pair to pair.
void loop_alone(benchmark::State& state, const Course& course) {
  Trace trace(course);
  for (auto _ : state) {
    Vec3 p_AB = trace.X_WB().p - trace.pair().X_WA.p;
    benchmark::DoNotOptimize(p_AB);
    trace.advance();
  }
}

/// The pair function alone, between centres that are known.
void sphere_function(benchmark::State& state, const Course& course) {
  Trace trace(course);
  for (auto _ : state) {
    const Pair& pair = trace.pair();
    Manifold manifold = collide_sphere_sphere(*std::get_if<Sphere>(&pair.a), *std::get_if<Sphere>(&pair.b),
                                              trace.X_WB().p - pair.X_WA.p, 0.0);
    benchmark::DoNotOptimize(manifold);
    trace.advance();
  }
}

void tumble_kept(benchmark::State& state, const Course& course, const NarrowPhaseOptions& options) {
  Trace trace(course);
  std::vector<PairCache> caches(Trace::kPairs);
  std::vector<Manifold> manifolds(Trace::kPairs);
  NarrowPhaseCounters counters;
  for (auto _ : state) {
    const Pair& pair = trace.pair();
    Manifold& manifold = manifolds[trace.index()];
    update_manifold(pair.a, pair.X_WA, pair.b, trace.X_WB(), 0.0, options, caches[trace.index()], counters,
                    manifold);
    benchmark::DoNotOptimize(manifold);
    trace.advance();
  }
  const auto share = [&](std::uint64_t count) {
    return static_cast<double>(count) / static_cast<double>(counters.queries);
  };
  state.counters["unmoved"] = share(counters.unmoved);
  state.counters["by_motion"] = share(counters.motion_bound);
  state.counters["by_axis"] = share(counters.cached_axis);
  state.counters["by_gjk"] = share(counters.gjk);
  state.counters["exact"] = share(counters.exact);
  state.counters["facet_kept"] = share(counters.facet_kept);
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
btBoxShape to_bullet(const Shape& shape) {
  const Vec3& h = std::get_if<Box>(&shape)->half_extents;
  return btBoxShape(btVector3(h.x(), h.y(), h.z()));
}

void bullet_boxes(benchmark::State& state, const Course& course) {
  Trace trace(course);
  std::vector<btBoxShape> a, b;
  std::vector<btDiscreteCollisionDetectorInterface::ClosestPointInput> inputs;
  for (const Pair& pair : trace.pairs()) {
    a.push_back(to_bullet(pair.a));
    b.push_back(to_bullet(pair.b));
    inputs.emplace_back();
    inputs.back().m_transformA = to_bullet(pair.X_WA);
  }
  BulletPoints points;
  for (auto _ : state) {
    const std::size_t i = trace.index();
    inputs[i].m_transformB = to_bullet(trace.X_WB());
    btBoxBoxDetector detector(&a[i], &b[i]);
    detector.getClosestPoints(inputs[i], points, nullptr);
    benchmark::DoNotOptimize(points.count);
    trace.advance();
  }
  state.counters["points"] = static_cast<double>(points.count) / static_cast<double>(state.iterations());
}

struct OdePlace {
  explicit OdePlace(const Pose& X) : position{X.p.x(), X.p.y(), X.p.z()} {
    const Mat3 R = rotation_matrix(X.q);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) rotation[4 * i + j] = R(i, j);
    }
  }
  dVector3 position;
  dMatrix3 rotation{};
};
struct OdeSides {
  explicit OdeSides(const Shape& shape) {
    for (int i = 0; i < 3; ++i) sides[i] = 2.0 * std::get_if<Box>(&shape)->half_extents[i];
  }
  dVector3 sides;
};

void ode_boxes(benchmark::State& state, const Course& course) {
  Trace trace(course);
  std::vector<OdePlace> place_a;
  std::vector<OdeSides> a, b;
  for (const Pair& pair : trace.pairs()) {
    place_a.emplace_back(pair.X_WA);
    a.emplace_back(pair.a);
    b.emplace_back(pair.b);
  }
  std::array<dContactGeom, 8> contacts;
  std::uint64_t points = 0;
  for (auto _ : state) {
    const std::size_t i = trace.index();
    const OdePlace place_b(trace.X_WB());
    dVector3 normal;
    dReal depth = 0;
    int axis = 0;
    points += static_cast<std::uint64_t>(dBoxBox(place_a[i].position, place_a[i].rotation, a[i].sides,
                                                 place_b.position, place_b.rotation, b[i].sides, normal,
                                                 &depth, &axis, 8, contacts.data(), sizeof(dContactGeom)));
    benchmark::DoNotOptimize(contacts);
    trace.advance();
  }
  state.counters["points"] = static_cast<double>(points) / static_cast<double>(state.iterations());
}

struct PlacedShape {
  PlacedShape(const Shape& placed, const Pose& X) : shape(placed), R(rotation_matrix(X.q)), p(X.p) {}
  const Shape& shape;
  Mat3 R;
  Vec3 p;
};

void ccd_support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const PlacedShape& placed = *static_cast<const PlacedShape*>(object);
  const Vec3 d(direction->v[0], direction->v[1], direction->v[2]);
  const Vec3 v = placed.R * support(placed.shape, placed.R.transpose() * d) + placed.p;
  ccdVec3Set(out, v.x(), v.y(), v.z());
}
void ccd_centre(const void* object, ccd_vec3_t* out) {
  const Vec3& p = static_cast<const PlacedShape*>(object)->p;
  ccdVec3Set(out, p.x(), p.y(), p.z());
}

/// Default tolerances; the iteration limit keeps touching pairs from cycling for ever.
void plain_libccd(benchmark::State& state, const Course& course, bool mpr) {
  Trace trace(course);
  std::vector<PlacedShape> placed_a;
  for (const Pair& pair : trace.pairs()) placed_a.emplace_back(pair.a, pair.X_WA);
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = ccd_support;
  ccd.center1 = ccd.center2 = ccd_centre;
  ccd.max_iterations = 500;
  for (auto _ : state) {
    const PlacedShape& a = placed_a[trace.index()];
    const PlacedShape b(trace.pair().b, trace.X_WB());
    ccd_real_t depth = 0;
    ccd_vec3_t normal, position;
    benchmark::DoNotOptimize(mpr ? ccdMPRPenetration(&a, &b, &ccd, &depth, &normal, &position)
                                 : ccdGJKPenetration(&a, &b, &ccd, &depth, &normal, &position));
    benchmark::DoNotOptimize(depth);
    trace.advance();
  }
}

class Registry {
 public:
  /// 0 queries: as many as it takes to measure.
  Registry(std::int64_t queries, bool shuffled) : queries_(queries), shuffled_(shuffled) {}

  template <typename Run, typename... Arguments>
  void add(const std::string& name, Run run, Make make, double pace, Arguments... arguments) {
    auto* const benchmark =
        benchmark::RegisterBenchmark(name.c_str(), run, Course{make, pace, shuffled_}, arguments...);
    if (queries_ > 0) benchmark->Iterations(queries_);
  }
  /// Where nothing moves, every query forgets the pair.
  void add_class(const std::string& name, Make make, double pace = 0.0) {
    if (pace > 0.0) {
      add(name + "/tumble", tumble_kept, make, pace, NarrowPhaseOptions{});
    } else {
      add(name + "/tumble_cold", tumble_cold, make, pace);
    }
    add(name + "/ccdGJKPenetration", plain_libccd, make, pace, false);
    add(name + "/ccdMPRPenetration", plain_libccd, make, pace, true);
  }
  void add_boxes(const std::string& name, Make make, double pace = 0.0) {
    add_class(name, make, pace);
    add(name + "/bullet", bullet_boxes, make, pace);
    add(name + "/ode", ode_boxes, make, pace);
  }

 private:
  std::int64_t queries_;
  bool shuffled_;
};

void register_polytopes(Registry& registry) {
  NarrowPhaseOptions no_motion_bound, no_kept_manifold;
  no_motion_bound.use_motion_bound = false;
  no_kept_manifold.use_kept_manifold = false;
  registry.add_boxes("box_face", box_face);
  registry.add_boxes("box_edge", box_edge);
  registry.add_boxes("box_deep", box_deep);
  registry.add_boxes("box_resting", box_face, 1e-6);
  registry.add_boxes("box_calm", box_calm, 1e-6);
  registry.add_boxes("box_moving", box_pass, 2e-3);
  registry.add("box_face/tumble_unmoved", tumble_kept, box_face, 0.0, NarrowPhaseOptions{});
  registry.add("box_apart/tumble_motion_bound", tumble_kept, box_apart, 1e-6, NarrowPhaseOptions{});
  registry.add("box_apart/tumble_cached_axis", tumble_kept, box_apart, 1e-6, no_motion_bound);
  registry.add_class("hull32_shallow", hull_shallow);
  registry.add_class("hull32_deep", hull_deep);
  registry.add_class("hull32_resting", hull_rest, 1e-7);
  registry.add_class("hull32_calm", hull_calm, 1e-7);
  registry.add_class("hull32_moving", hull_pass, 2e-3);
  registry.add("hull32_shallow/tumble_facet_kept", tumble_kept, hull_shallow, 0.0, no_kept_manifold);
  registry.add("hull32_apart/tumble_motion_bound", tumble_kept, hull_apart, 1e-6, NarrowPhaseOptions{});
  registry.add("hull32_apart/tumble_cached_axis", tumble_kept, hull_apart, 1e-6, no_motion_bound);
}

void register_curved(Registry& registry) {
  registry.add_class("sphere_sphere", sphere_sphere);
  registry.add("sphere_sphere/loop_alone", loop_alone, sphere_sphere, 0.0);
  registry.add("sphere_sphere/function", sphere_function, sphere_sphere, 0.0);
  registry.add("sphere_sphere/tumble", tumble_kept, sphere_sphere, 1e-6, NarrowPhaseOptions{});
  registry.add_class("cylinder_on_box", cylinder_on_box);
  registry.add_class("cylinder_resting", cylinder_on_box, 1e-6);
  registry.add_class("box_cylinder", box_cylinder);
  registry.add_class("box_cylinder_deep", box_cylinder_deep);
  registry.add_class("cylinder_cylinder", cylinder_cylinder);
  registry.add_class("cylinder_moving", cylinder_pass, 2e-3);
  registry.add_class("cone_cylinder", cone_cylinder);
  registry.add_class("ellipsoid_ellipsoid", ellipsoid_ellipsoid);
  registry.add_class("ellipsoid_ellipsoid_deep", ellipsoid_ellipsoid_deep);
  registry.add_class("sphere_ellipsoid", sphere_ellipsoid);
}

void register_terrain(Registry& registry) {
  registry.add("sphere_on_terrain/tumble_cold", tumble_cold, sphere_on_terrain, 0.0);
  registry.add("box_on_terrain/tumble_cold", tumble_cold, box_on_terrain, 0.0);
  registry.add("hull32_on_terrain/tumble_cold", tumble_cold, hull_on_terrain, 0.0);
  registry.add("capsule_on_terrain/tumble_cold", tumble_cold, capsule_on_terrain, 0.0);
  registry.add("cylinder_on_terrain/tumble_cold", tumble_cold, cylinder_on_terrain, 0.0);
  registry.add("cone_on_terrain/tumble_cold", tumble_cold, cone_on_terrain, 0.0);
  registry.add("ellipsoid_on_terrain/tumble_cold", tumble_cold, ellipsoid_on_terrain, 0.0);
}

/// Takes the argument that begins with `option` out of them; null if there is none.
const char* take(std::string_view option, int& argc, char** argv) {
  const auto is_it = [&](const char* argument) { return std::string_view(argument).starts_with(option); };
  char** const found = std::find_if(argv + 1, argv + argc, is_it);
  if (found == argv + argc) return nullptr;
  const char* const argument = *found;
  std::copy(found + 1, argv + argc, found);
  --argc;
  return argument + option.size();
}

}  // namespace

int main(int argc, char** argv) {
  const char* const queries = take("--queries=", argc, argv);
  const bool shuffled = take("--shuffled", argc, argv) != nullptr;
  Registry registry(queries != nullptr ? std::stoll(queries) : 0, shuffled);
  register_polytopes(registry);
  register_curved(registry);
  register_terrain(registry);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
