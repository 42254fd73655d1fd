// Queries of the world: the tree's answer is the answer of looking at everything, to the bit; and the answers are right.
#include "world/query.h"

#include <gtest/gtest.h>

#include "collision/distance.h"
#include "collision/ray_cast.h"
#include "collision/shape_cast.h"
#include "support/world_builder.h"
#include "unit/collision/sample_shapes.h"

namespace tumble::test {
namespace {

/// Bodies of all types, turned and tumbling, some with two geometries, on a ground; after some steps of falling.
World random_world(unsigned seed, int bodies, int steps) {
  RandomPose random(seed);
  World world;
  world.create_body(ground());
  for (int i = 0; i < bodies; ++i) {
    const auto shapes = random_shapes(random, 0.1, 0.4);
    BodyDefinition definition =
        body("body" + std::to_string(i), shapes[static_cast<std::size_t>(i) % shapes.size()],
             random.vector(-4.0, 4.0) + Vec3(0, 0, 5.0));
    definition.X_WL.q = random.rotation();
    definition.v_WB = random.vector(-5.0, 5.0);
    definition.w_WB = random.vector(-5.0, 5.0);
    if (i % 5 == 0) definition.type = BodyType::fixed;
    if (i % 3 == 0) {
      definition.geometries.push_back(geometry(shapes[1]));
      definition.geometries[1].X_LS = random.pose(0.5);
    }
    world.create_body(definition);
  }
  run(world, steps);
  return world;
}

/// Calls visit(body, number of the geometry, geometry, its pose) for everything there is.
template <typename Visit>
void for_each_geometry(const World& world, Visit visit) {
  for (std::uint32_t slot = 0; slot < world.body_capacity(); ++slot) {
    const auto& own = world.body(slot).geometries;
    for (std::uint32_t i = 0; i < own.size(); ++i) {
      const Geometry& geometry = world.geometries()[own[i]];
      visit(world.id(slot), i, geometry, world.geometry_pose(geometry));
    }
  }
}

struct Nearest {
  double at = kEndless;
  BodyId body;
  std::uint32_t geometry = 0;
  int count = 0;
};

TEST(Query, RaysMeetWhatLookingAtEverythingMeets) {
  for (const int steps : {0, 1, 60, 240}) {
    const World world = random_world(31, 120, steps);
    RandomPose random(32);
    int hits = 0, misses = 0, inside = 0;
    for (int i = 0; i < 500; ++i) {
      const Vec3 origin = random.vector(-6.0, 6.0) + Vec3(0, 0, 4.0), d = random.direction();
      const double length = i % 2 ? kEndless : random.uniform(0.1, 8.0);
      Nearest nearest;
      for_each_geometry(
          world, [&](BodyId body, std::uint32_t number, const Geometry& geometry, const Pose& X_WS) {
            const Quat q_SW = X_WS.q.conjugate();
            const auto hit =
                cast_ray(geometry.shape, Ray{q_SW * (origin - X_WS.p), q_SW * d.stableNormalized(), length});
            if (!hit) return;
            ++nearest.count;
            if (hit->distance < nearest.at) nearest = {hit->distance, body, number, nearest.count};
          });
      const auto hit = cast_ray(world, origin, d, length);
      const auto all = cast_ray_through(world, origin, d, length);
      ASSERT_EQ(hit.has_value(), nearest.count > 0);
      ASSERT_EQ(all.size(), static_cast<std::size_t>(nearest.count));
      (hit ? hits : misses)++;
      if (!hit) continue;
      inside += hit->inside;
      EXPECT_EQ(hit->distance, nearest.at);
      EXPECT_EQ(hit->body, nearest.body);
      EXPECT_EQ(hit->geometry, nearest.geometry);
      EXPECT_EQ(hit->fraction, nearest.at / length);
      EXPECT_EQ(all[0].body, hit->body);
      EXPECT_EQ(all[0].distance, hit->distance);
      EXPECT_TRUE(std::is_sorted(all.begin(), all.end(), [](const QueryHit& a, const QueryHit& b) {
        return a.distance < b.distance;
      }));
    }
    EXPECT_GT(hits, 200);
    EXPECT_GT(misses, 50);
    EXPECT_GT(inside, 5);
  }
}

/// The trees are only as good as their boxes: after every step, however hard bodies were kicked in it, and after every
/// command, each box holds its geometry.
TEST(Query, BoxesHoldTheirGeometryBetweenSteps) {
  RandomPose random(37);
  World world = random_world(38, 150, 0);
  const auto count_outside = [&] {
    int outside = 0;
    for (std::uint32_t i = 0; i < world.geometries().size(); ++i) {
      const Geometry& geometry = world.geometries()[i];
      outside += !world.broad_phase().fat_bounds(i).contains(
          compute_aabb(geometry.shape, world.geometry_pose(geometry)));
    }
    return outside;
  };
  for (int step = 0; step < 100; ++step) {
    // A kick of 100 m/s: 0.4 m in the step that no one knew of before.
    const std::uint32_t slot = 1 + static_cast<std::uint32_t>(step) % 150;
    if (world.body(slot).type == BodyType::dynamic) {
      Push push{.body = world.id(slot)};
      push.force = 100.0 / world.options().time_step * world.mass_properties(slot).mass * random.direction();
      world.push(push);
    }
    world.step();
    ASSERT_EQ(count_outside(), 0) << step;
    const std::uint32_t other = 1 + static_cast<std::uint32_t>(step * 7) % 150;
    if (world.body(other).type == BodyType::dynamic) {
      world.set_motion(world.id(other), random.pose(4.0), random.vector(-50, 50), random.vector(-20, 20));
    }
    ASSERT_EQ(count_outside(), 0) << step;
  }
}

TEST(Query, MovedShapesMeetWhatLookingAtEverythingMeets) {
  const World world = random_world(33, 120, 100);
  RandomPose random(34);
  int hits = 0, misses = 0, inside = 0;
  for (int i = 0; i < 100; ++i) {
    for (const Shape& shape : random_shapes(random, 0.05, 0.2)) {
      const Pose X_WS{random.rotation(), random.vector(-6.0, 6.0) + Vec3(0, 0, 4.5)};
      const Vec3 way = random.vector(-4.0, 4.0);
      Nearest nearest;
      for_each_geometry(
          world, [&](BodyId body, std::uint32_t number, const Geometry& geometry, const Pose& X_WG) {
            const Quat q_SW = X_WS.q.conjugate();
            const auto hit =
                cast_shape(shape, geometry.shape, {q_SW * X_WG.q, q_SW * (X_WG.p - X_WS.p)}, q_SW * way);
            if (!hit) return;
            ++nearest.count;
            if (hit->fraction < nearest.at) nearest = {hit->fraction, body, number, nearest.count};
          });
      const auto hit = cast_shape(world, shape, X_WS, way);
      ASSERT_EQ(hit.has_value(), nearest.count > 0);
      (hit ? hits : misses)++;
      if (!hit) continue;
      inside += hit->inside;
      EXPECT_EQ(hit->fraction, nearest.at);
      EXPECT_EQ(hit->body, nearest.body);
      EXPECT_EQ(hit->geometry, nearest.geometry);
      if (!hit->inside) {
        EXPECT_LE(hit->normal_W.dot(way), 0.0);
      }
    }
  }
  EXPECT_GT(hits, 100);
  EXPECT_GT(misses, 50);
  EXPECT_GT(inside, 10);
}

TEST(Query, PlacesHoldWhatLookingAtEverythingFinds) {
  const World world = random_world(35, 150, 100);
  RandomPose random(36);
  std::size_t overlapping = 0, in_box = 0;
  for (int i = 0; i < 100; ++i) {
    for (const Shape& shape : random_shapes(random, 0.2, 1.0)) {
      const Pose X_WS{random.rotation(), random.vector(-5.0, 5.0) + Vec3(0, 0, 4.0)};
      const Aabb box = compute_aabb(shape, X_WS);
      std::vector<BodyId> truth, truth_in_box;
      for_each_geometry(world, [&](BodyId body, std::uint32_t, const Geometry& geometry, const Pose& X_WG) {
        if ((truth_in_box.empty() || truth_in_box.back() != body) &&
            compute_aabb(geometry.shape, X_WG).overlaps(box)) {
          truth_in_box.push_back(body);
        }
        if (!truth.empty() && truth.back() == body) return;
        // Not by the narrow phase, which the query asks, but by the distance search.
        const Quat q_SW = X_WS.q.conjugate();
        const bool meets =
            std::holds_alternative<HalfSpace>(geometry.shape)
                ? box.lower.z() <= 0.0
                : compute_distance(shape, geometry.shape, {q_SW * X_WG.q, q_SW * (X_WG.p - X_WS.p)}).overlap;
        if (meets) truth.push_back(body);
      });
      EXPECT_EQ(find_overlapping(world, shape, X_WS), truth);
      EXPECT_EQ(find_in_box(world, box), truth_in_box);
      overlapping += truth.size();
      in_box += truth_in_box.size();
    }
  }
  EXPECT_GT(overlapping, 300u);
  EXPECT_GT(in_box, overlapping);
}

TEST(Query, FiltersAndNames) {
  World world;
  const BodyId low = world.create_body(body("low", Box{Vec3::Ones()}, Vec3::Zero()));
  BodyDefinition definition = body("high", Sphere{1.0}, Vec3(0, 0, 5));
  definition.geometries.push_back(geometry(Sphere{1.0}));
  definition.geometries[1].X_LS.p = Vec3(0, 0, 3);
  const BodyId high = world.create_body(definition);
  const Vec3 from(0, 0, 20), down(0, 0, -7);
  const auto first = cast_ray(world, from, down);
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->body, high);
  EXPECT_EQ(first->geometry, 1u);
  EXPECT_EQ(first->distance, 11.0);
  EXPECT_EQ(first->fraction, 0.0);
  EXPECT_EQ(first->p_W, Vec3(0, 0, 9));
  EXPECT_EQ(first->normal_W, Vec3::UnitZ());
  const auto second = cast_ray(world, from, down, 38.0, [&](BodyId id) { return id != high; });
  ASSERT_TRUE(second.has_value());
  EXPECT_EQ(second->body, low);
  EXPECT_EQ(second->fraction, 0.5);
  const auto all = cast_ray_through(world, from, down);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[1].body, high);
  EXPECT_EQ(all[1].geometry, 0u);
  EXPECT_EQ(all[2].body, low);
  EXPECT_FALSE(cast_ray(world, from, down, 10.5).has_value());

  const auto cast = cast_shape(world, Box{Vec3::Constant(0.5)}, {Quat::Identity(), from}, Vec3(0, 0, -21),
                               [&](BodyId id) { return id != high; });
  ASSERT_TRUE(cast.has_value());
  EXPECT_NEAR(cast->distance, 18.5, 1e-13);
  EXPECT_NEAR(cast->fraction, 18.5 / 21.0, 1e-14);
  EXPECT_EQ(cast->normal_W, Vec3::UnitZ());
  EXPECT_NEAR(cast->p_W.z(), 1.0, 1e-13);

  EXPECT_EQ(find_overlapping(world, Sphere{4.5}, {Quat::Identity(), Vec3(0, 0, 4.5)}),
            (std::vector{low, high}));
  EXPECT_EQ(find_in_box(world, {Vec3(-9, -9, 8.5), Vec3(9, 9, 9)}), std::vector{high});
  world.destroy_body(high);
  EXPECT_EQ(cast_ray(world, from, down)->body, low);
}

TEST(Query, ClosestPointsOfBodies) {
  World world;
  const BodyId plane = world.create_body(ground());
  const BodyId box = world.create_body(body("box", Box{Vec3::Ones()}, Vec3(0, 0, 3)));
  BodyDefinition definition = body("pair", Sphere{1.0}, Vec3(10, 0, 3));
  definition.geometries.push_back(geometry(Sphere{1.0}));
  definition.geometries[1].X_LS.p = Vec3(-4, 0, 0);
  const BodyId pair = world.create_body(definition);
  const BodyId sunk = world.create_body(body("sunk", Box{Vec3::Ones()}, Vec3(0, 0, 4.75)));
  const auto gap = compute_closest_points(world, box, pair);
  ASSERT_TRUE(gap.has_value());
  EXPECT_NEAR(gap->distance, 4.0, 1e-14);
  EXPECT_NEAR((gap->p_WA - Vec3(1, 0, 3)).norm(), 0.0, 1e-14);
  EXPECT_NEAR((gap->p_WB - Vec3(5, 0, 3)).norm(), 0.0, 1e-14);
  EXPECT_NEAR((gap->normal_W - Vec3::UnitX()).norm(), 0.0, 1e-15);
  const auto back = compute_closest_points(world, pair, box);
  EXPECT_NEAR(back->distance, 4.0, 1e-14);
  EXPECT_NEAR((back->p_WB - Vec3(1, 0, 3)).norm(), 0.0, 1e-14);
  const auto height = compute_closest_points(world, box, plane);
  ASSERT_TRUE(height.has_value());
  EXPECT_EQ(height->distance, 2.0);
  EXPECT_EQ(height->normal_W, -Vec3::UnitZ());
  EXPECT_EQ(height->p_WA.z(), 2.0);
  EXPECT_EQ(height->p_WB.z(), 0.0);
  const auto overlap = compute_closest_points(world, box, sunk);
  ASSERT_TRUE(overlap.has_value());
  EXPECT_NEAR(overlap->distance, -0.25, 1e-15);
  EXPECT_NEAR(overlap->p_WA.z(), 4.0, 1e-15);
  EXPECT_NEAR(overlap->p_WB.z(), 3.75, 1e-15);
  EXPECT_FALSE(compute_closest_points(world, plane, plane).has_value());
}

/// What `call` throws, or "".
template <typename Call>
std::string reason_of(Call call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Query, BadQuestionsAreRefusedByField) {
  World world;
  const Vec3 o = Vec3::Zero(), x = Vec3::UnitX();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(reason_of([&] { cast_ray(world, o, o); }), "direction: must not be zero (0 0 0)");
  EXPECT_EQ(reason_of([&] { cast_ray(world, Vec3(0, nan, 0), x); }), "origin: must be finite (0 nan 0)");
  EXPECT_EQ(reason_of([&] { cast_ray_through(world, o, x, -1.0); }), "length: must be > 0 (-1)");
  EXPECT_EQ(reason_of([&] { cast_ray(world, o, x, nan); }), "length: must be > 0 (nan)");
  EXPECT_EQ(reason_of([&] { cast_shape(world, HalfSpace{}, {}, x); }),
            "shape: a half_space cannot be asked with");
  EXPECT_EQ(reason_of([&] { cast_shape(world, Sphere{-1.0}, {}, x); }),
            "shape: radius: must be finite and > 0, is -1");
  EXPECT_EQ(reason_of([&] { cast_shape(world, Sphere{1.0}, {}, Vec3(0, 0, kEndless)); }),
            "way: must be finite (0 0 inf)");
  EXPECT_EQ(reason_of([&] {
              find_overlapping(world, Sphere{1.0}, {Quat(2, 0, 0, 0), o});
            }),
            "orientation: quaternion must have length 1 (squared length 4)");
  EXPECT_EQ(reason_of([&] { find_in_box(world, {x, o}); }), "box: lower must be <= upper (1 0 0, 0 0 0)");
  EXPECT_EQ(reason_of([&] {
              compute_closest_points(world, {7, 1}, {7, 1});
            }),
            "body: no such body (index 7, generation 1)");
}

}  // namespace
}  // namespace tumble::test
