// The proof that an overlap is as deep as it looks: it ends searches early without changing their answers, and it never
// proves what is not so.
#include "collision/depth_proof.h"

#include <gtest/gtest.h>

#include "collision/distance.h"
#include "collision/nearest_surface.h"
#include "collision/segment.h"
#include "collision/separation_search.h"
#include "math/rotation.h"
#include "random_pose.h"
#include "sample_shapes.h"

namespace tumble::test {
namespace {

struct Answers {
  Separation proven, searched;
  double size;
};

Answers search_twice(const Shape& shape_a, const Shape& shape_b, const Pose& X_AB) {
  const ConvexPieces a(shape_a, Mat3::Identity(), Vec3::Zero()), b(shape_b, rotation_matrix(X_AB.q), X_AB.p);
  const Vec3 guess = direction_or(X_AB.p, Vec3::UnitZ());
  const double size = a.radius() + b.radius(), enough = 0.1 * size;
  return {find_separation(a, b, guess, enough), find_separation(a, b, guess, enough, false), size};
}

/// B touches A along a random direction and is moved in by this share of the way to A's centre, or out.
Pose place(RandomPose& random, const Shape& a, const Shape& b, double share) {
  const Quat q = random.rotation();
  const Vec3 d = random.direction();
  return {q, (1.0 - share) * (support(a, d) - q * support(b, q.conjugate() * -d))};
}

TEST(DepthProof, EndsTheSearchWithoutChangingItsAnswer) {
  RandomPose random(71);
  double worst = 0.0;
  int proven = 0, all = 0;
  for (int i = 0; i < 150; ++i) {
    for (std::size_t type_b = 4; type_b < 7; ++type_b) {
      for (std::size_t type_a = 0; type_a <= type_b; ++type_a) {
        const Shape a = random_shape(random, type_a, 0.2), b = random_shape(random, type_b, 0.2);
        for (const double share : {1e-6, 1e-3, 0.3, -0.02}) {
          const Answers answers = search_twice(a, b, place(random, a, b, share));
          EXPECT_FALSE(answers.searched.proven);
          const double change = std::abs(answers.proven.separation - answers.searched.separation);
          worst = std::max(worst, change / answers.size);
          proven += answers.proven.proven;
          ++all;
        }
      }
    }
  }
  EXPECT_LE(worst, 2e-11);       // measured 7.5e-12: each is right to 1e-11 of the size
  EXPECT_GT(proven, 0.6 * all);  // measured 0.75
}

// The answer for what lies or stands, on faces, sides and caps: the place of contact is all that is looked at.
TEST(DepthProof, KnowsWhatRests) {
  RandomPose random(72);
  const Shape table = Box{Vec3(1.0, 1.0, 0.5)};
  const Cylinder cylinder{0.3, 0.4};
  const Cone cone{0.3, 0.4};
  const Quat lying = exp_map(Vec3(1.5707963267948966, 0.0, 0.0));
  const Quat on_side = exp_map(Vec3(1.5707963267948966 + std::atan2(0.3, 0.8), 0.0, 0.0));
  const std::vector<std::pair<Shape, Quat>> resting = {{cylinder, Quat::Identity()},
                                                       {cylinder, lying},
                                                       {cone, Quat::Identity()},
                                                       {cone, on_side},
                                                       {Ellipsoid{Vec3(0.3, 0.2, 0.1)}, Quat::Identity()}};
  for (const auto& [shape, q] : resting) {
    for (const double tilt : {0.0, 1e-9, 1e-6, 1e-3}) {
      for (const double depth : {1e-9, 1e-5, 1e-2, -1e-5}) {
        const Quat q_AB = normalized(exp_map(tilt * random.direction()) * q);
        const double height = 0.5 - (q_AB * support(shape, q_AB.conjugate() * -Vec3::UnitZ())).z() - depth;
        const Pose X_AB{q_AB, Vec3(0.1, -0.2, height)};
        const Answers answers = search_twice(table, shape, X_AB);
        EXPECT_TRUE(answers.proven.proven) << shape_name(shape) << ' ' << tilt << ' ' << depth;
        EXPECT_NEAR(answers.proven.separation, -depth, 1e-14);  // measured 2.7e-16
      }
    }
  }
}

// A box deep in another has three ways out; along each of them the overlap is least among its neighbours.
TEST(DepthProof, RefusesTheLongerWayOut) {
  const Shape shape_a = Box{Vec3(1.0, 1.0, 1.0)}, shape_b = Ellipsoid{Vec3(0.2, 0.2, 0.2)};
  const Pose X_AB{Quat::Identity(), Vec3(0.9, 0.5, 0.0)};
  const ConvexPieces a(shape_a, Mat3::Identity(), Vec3::Zero()), b(shape_b, Mat3::Identity(), X_AB.p);
  const auto way_out = [&](int axis) {
    CandidateDirection way;
    way.n = Vec3::Unit(axis);
    way.p_B = X_AB.p - 0.2 * way.n;
    way.h = 1.0 - way.p_B[axis];
    way.p_A = way.p_B + way.h * way.n;
    way.add({0, 0});
    return way;
  };
  EXPECT_TRUE(is_proven(a, b, way_out(0), 1e-11));
  EXPECT_FALSE(is_proven(a, b, way_out(1), 1e-11));
  EXPECT_FALSE(is_proven(a, b, way_out(2), 1e-11));
  // Nor less than what is needed to come out there.
  CandidateDirection deeper = way_out(0);
  deeper.h += 0.1;
  deeper.p_A.x() += 0.1;
  EXPECT_FALSE(is_proven(a, b, deeper, 1e-11));
}

// The distance that a small ball inside would have to go is that to the surface.
TEST(DepthProof, DepthsAreDistancesToTheSurface) {
  RandomPose random(73);
  for (std::size_t type = 2; type < 7; ++type) {
    for (int i = 0; i < 200; ++i) {
      const Shape shape = random_shape(random, type, 0.2);
      const ConvexPieces pieces(shape, Mat3::Identity(), Vec3::Zero());
      const Vec3 d = random.direction(), p = random.uniform(0.0, 1.0) * support(shape, d);
      const double depth = pieces.depth(p);
      double least =
          kInfinity;  // over planes that touch the shape: never below the depth, and near it for some
      for (int k = 0; k < 2000; ++k) {
        const Vec3 n = random.direction();
        least = std::min(least, n.dot(support(shape, n) - p));
      }
      EXPECT_GE(least, depth - 1e-12);
      EXPECT_LE(least, depth + 0.1 * bounding_radius(shape));
    }
  }
}

}  // namespace
}  // namespace tumble::test
