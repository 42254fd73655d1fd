// No query of two shapes takes memory from the heap: contacts, cold or warm, casts and distances, also of surfaces.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "allocation_counter.h"
#include "collision/distance.h"
#include "collision/narrow_phase.h"
#include "collision/ray_cast.h"
#include "collision/shape_cast.h"
#include "collision/surface_query.h"
#include "sample_hulls.h"
#include "support/surface_meshes.h"

namespace {
std::uint64_t allocations = 0;
}

// Not inlined: g++ 12 takes an inlined free() for a mismatch with new.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size,
                                     const std::nothrow_t&) noexcept {  // std::stable_sort's
  ++allocations;
  return std::malloc(size);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace tumble::test {

std::uint64_t allocation_count() {
  return allocations;
}

namespace {

TEST(Allocation, NoQueryAllocates) {
  RandomPose random(61);
  const std::vector<Shape> shapes = {HalfSpace{},
                                     Sphere{0.4},
                                     Capsule{0.3, 0.6},
                                     Box{Vec3(0.5, 0.3, 0.7)},
                                     random_hull(random, 16, Vec3(0.6, 0.5, 0.7)),
                                     Cylinder{0.4, 0.5},
                                     Cone{0.4, 0.5},
                                     Ellipsoid{Vec3(0.5, 0.4, 0.6)},
                                     flat_mesh(1, 4.0, false)};
  const std::size_t count = shapes.size();
  NarrowPhaseCounters counters;
  const std::uint64_t before = allocation_count();
  for (std::size_t i = 0; i < 5000; ++i) {
    const Shape& a = shapes[i % count];
    const Shape& b = shapes[i / count % count];
    const Pose X_WA = random.pose(0.7), X_WB = random.pose(0.7);
    PairCache cache;
    for (int again = 0; again < 2; ++again) collide(a, X_WA, b, X_WB, 0.05, {}, cache, counters);
  }
  EXPECT_EQ(allocation_count(), before);
  EXPECT_GT(counters.exact, 1000u);
  EXPECT_GT(counters.triangles, 500u);
}

TEST(Allocation, NoCastOrDistanceAllocates) {
  RandomPose random(62);
  const std::vector<Shape> shapes = {Sphere{0.4},
                                     Capsule{0.3, 0.6},
                                     Box{Vec3(1, 2, 1)},
                                     random_hull(random, 100, Vec3(0.6, 0.5, 0.7)),
                                     Cylinder{0.4, 0.5},
                                     Cone{0.4, 0.5},
                                     Ellipsoid{Vec3(0.5, 0.4, 0.6)}};
  const std::size_t count = shapes.size();
  int rays = 0, casts = 0, apart = 0;
  const std::uint64_t before = allocation_count();
  for (std::size_t i = 0; i < 3000; ++i) {
    const Shape& a = shapes[i % count];
    const Shape& b = shapes[i / count % count];
    const Pose X_AB = random.pose(2.0);
    const Vec3 d = random.direction();
    rays += cast_ray(b, {-2.0 * d, d}).has_value();
    casts += cast_shape(a, b, X_AB, 2.0 * d).has_value();
    apart += !compute_distance(a, b, X_AB).overlap;
  }
  EXPECT_EQ(allocation_count(), before);
  EXPECT_GT(rays, 1000);
  EXPECT_GT(casts, 300);
  EXPECT_GT(apart, 500);
}

TEST(Allocation, NoSurfaceQueryAllocates) {
  RandomPose random(63);
  const std::vector<Shape> shapes = {Sphere{0.4}, Capsule{0.3, 0.6}, Box{Vec3(0.5, 0.3, 0.7)},
                                     random_hull(random, 16, Vec3(0.6, 0.5, 0.7)), Cone{0.4, 0.5}};
  const std::vector<Shape> surfaces = {
      box_mesh(Vec3(1, 1, 1), 6),
      std::make_shared<const HeightField>(12, 12, 0.25, 0.25, std::vector<double>(144, 0.1))};
  int rays = 0, casts = 0, overlaps = 0, apart = 0;
  const std::uint64_t before = allocation_count();
  for (std::size_t i = 0; i < 1000; ++i) {
    const Shape& a = shapes[i % shapes.size()];
    const Shape& b = surfaces[i % surfaces.size()];
    const Pose X_AB = random.pose(2.0);
    const Vec3 d = random.direction();
    rays += cast_ray(b, {-2.0 * d, d}).has_value();
    casts += cast_shape(a, b, X_AB, X_AB.p).has_value();
    overlaps += overlaps_surface(a, *surface_of(b), X_AB);
    apart += !compute_distance(a, *surface_of(b), X_AB).overlap;
  }
  EXPECT_EQ(allocation_count(), before);
  EXPECT_GT(rays, 500);
  EXPECT_GT(casts, 500);
  EXPECT_GT(overlaps, 100);
  EXPECT_GT(apart, 500);
}

}  // namespace
}  // namespace tumble::test
