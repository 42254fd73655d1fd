// Cylinder, cone and ellipsoid against everything: the separation against an exhaustive search, and where the points of
// flat and straight contacts lie.
#include "collision/collide_curved.h"

#include <gtest/gtest.h>

#include "collision/distance.h"
#include "curved_reference.h"
#include "first_query.h"
#include "sample_shapes.h"

namespace tumble::test {
namespace {

constexpr double kQuarter = 1.5707963267948966;

enum class Overlap { shallow, deep, apart };

/// B at a random place: it touches A along a random direction, and is moved from there.
Pose place(RandomPose& random, const Shape& a, const Shape& b, Overlap overlap) {
  const double size = bounding_radius(a) + bounding_radius(b);
  const Quat q = random.rotation();
  const Vec3 d = random.direction();
  const double gap = size * random.log_uniform(1e-6, 2e-2), share = random.uniform(0.0, 1.0);
  const Vec3 touching = support(a, d) - q * support(b, q.conjugate() * -d);
  if (overlap == Overlap::deep) return {q, share * touching};
  return {q, touching + (overlap == Overlap::apart ? gap : -gap) * d};
}

/// Numbers of random_shape.
struct Types {
  std::size_t a, b;
};

class EveryCurvedPair : public ::testing::TestWithParam<Types> {
 protected:
  /// Error of a random contact's separation, of the shapes' size: against what its normal promises, and against the
  /// largest separation of all: apart, the distance of two points; in an overlap, that of the exhaustive search.
  double error(RandomPose& random, Overlap overlap, double least) {
    const Shape a = random_shape(random, GetParam().a, least), b = random_shape(random, GetParam().b, least);
    const Pose X_AB = place(random, a, b, overlap);
    const double size = bounding_radius(a) + bounding_radius(b);
    const DirectionReference reference(a, b, X_AB);
    const Manifold m = query(a, {}, b, X_AB, 0.05 * size);
    EXPECT_GE(m.count, 1) << shape_name(a) << ' ' << shape_name(b);
    EXPECT_NEAR(m.normal_A.norm(), 1.0, 1e-14);
    const auto promised = static_cast<double>(reference.separation(m.normal_A));
    const double most = overlap == Overlap::apart ? compute_distance(a, b, X_AB, {.budget = 400}).upper
                                                  : static_cast<double>(reference.search(800, 5).separation);
    reached_ += most >= promised - 1e-12 * size;
    ++queries_;
    return std::max(std::abs(least_separation(m) - promised), most - promised) / size;
  }

  int queries_ = 0, reached_ = 0;  ///< How often the reference itself finds what is there.
};

// 60 poses a pair and kind; tests/bench/contacts_accuracy_curved runs any number.
TEST_P(EveryCurvedPair, SeparatesAsMuchAsAnyDirection) {
  RandomPose random(static_cast<unsigned>(100 + 10 * GetParam().a + GetParam().b));
  for (int i = 0; i < 60; ++i) {
    for (const Overlap overlap : {Overlap::shallow, Overlap::deep, Overlap::apart}) {
      EXPECT_LE(error(random, overlap, 0.2), 1e-10) << "pose " << i;  // measured 5e-16, apart 1e-12
    }
  }
  EXPECT_GT(reached_, 0.9 * queries_);
}

TEST_P(EveryCurvedPair, NeedlesAndDiscs) {
  RandomPose random(static_cast<unsigned>(300 + 10 * GetParam().a + GetParam().b));
  for (int i = 0; i < 30; ++i) {
    for (const Overlap overlap : {Overlap::shallow, Overlap::deep}) {
      EXPECT_LE(error(random, overlap, 1e-3), 1e-9) << "pose " << i;
    }
  }
}

// Of the optimum next to it, found from gradients in 80 bits and from a direction beside it, so that it can't say yes to
// whatever it is given. tests/bench/contacts_accuracy_curved runs any number.
TEST_P(EveryCurvedPair, HasTheNormalOfItsOptimum) {
  RandomPose random(static_cast<unsigned>(500 + 10 * GetParam().a + GetParam().b));
  for (int i = 0; i < 40; ++i) {
    const Overlap overlap = i % 2 == 0 ? Overlap::shallow : Overlap::deep;
    const Shape a = random_shape(random, GetParam().a, 0.2), b = random_shape(random, GetParam().b, 0.2);
    const Pose X_AB = place(random, a, b, overlap);
    const Manifold m = query(a, {}, b, X_AB, 0.05);
    ASSERT_GE(m.count, 1);
    const Vec3 aside = (m.normal_A + 1e-5 * random.direction()).normalized();
    const Vec3L best = DirectionReference(a, b, X_AB).polish(aside).normal_A;
    EXPECT_LE(static_cast<double>((best - m.normal_A.cast<long double>()).norm()), 1e-10)
        << "pose " << i;  // measured 5e-12
  }
}

std::vector<Types> all_types() {
  std::vector<Types> types;
  for (std::size_t b = 4; b < 7; ++b) {
    for (std::size_t a = 0; a <= b; ++a) types.push_back({a, b});
  }
  return types;
}
INSTANTIATE_TEST_SUITE_P(All, EveryCurvedPair, ::testing::ValuesIn(all_types()));

/// Of two shapes whose frames differ by X_AB: what the best direction separates more than the contact's, of their size.
double missed_separation(const Shape& a, const Shape& b, const Pose& X_AB) {
  const double size = bounding_radius(a) + bounding_radius(b);
  const DirectionReference reference(a, b, X_AB);
  const Vec3 normal = query(a, {}, b, X_AB, 0.1 * size).normal_A;
  return static_cast<double>(reference.search(1200, 6).separation - reference.separation(normal)) / size;
}

// Two ways out that are equal to 1e-5 of the size, 13 degrees apart, of which the edge of the box blocks the sight of that
// past its corner. Found among 100 000 poses.
TEST(Curved, LooksBehindARidgeForTheShortestWayOut) {
  const Quat q(-0.18530324645292948, -0.26395640562224448, -0.35882319026249332, -0.87591988270322796);
  const Pose X_AB{q, Vec3(-1.1407500311507675, 0.83629337083155464, 0.657229097543929)};
  const Box box{Vec3(0.78640038752433439, 0.93498592058332508, 0.62981376846572401)};
  EXPECT_LE(missed_separation(box, Cylinder{0.28704863249646462, 0.24838330055194721}, X_AB), 1e-12);  // 0
}

// Axes in parallel, 6 mm apart: all ways round are nearly as good, and every one of them touches along a line.
TEST(Curved, FollowsARidgeToItsEnd) {
  const Pose X_AB{Quat(0, 0, 1, 0), Vec3(0.0056311655315060376, 0, 0.024608219131368608)};
  const Capsule capsule{0.83493657079574535, 0.56696758347794329};
  EXPECT_LE(missed_separation(capsule, Cylinder{0.45772264425075054, 0.59834589486658152}, X_AB),
            1e-12);  // 0
}

// A corner level with the rim of a cylinder: the origin lies in the plane of the rim's points of the difference, on neither
// side of its faces. Found among 100 000 poses.
TEST(Curved, SeesPastARimThatIsLevelWithACorner) {
  const Shape hull = std::make_shared<const ConvexHull>(build_convex_hull(
      {Vec3(-0.27, 0.21, 0.94), Vec3(-0.55, -0.82, 0.16), Vec3(-0.82, 0.31, -0.48), Vec3(-0.1, 0.68, 0.72)}));
  const Cylinder cylinder{0.7, 0.4};
  const Pose X_AB{Quat::Identity(), Vec3(-0.1, 0.68 + 0.7 - 1e-3, 0.72 + 0.4)};
  EXPECT_LE(missed_separation(hull, cylinder, X_AB), 1e-12);  // 0; was 3.2e-4
}

// The best way known lies on a ridge of two rims, where one of them bends down; 0.2 rad beside it this one has a minimum of
// its own, better by 1e-6 of the size. Found among 100 000 poses.
TEST(Curved, SeesTheWayOutBesideARidge) {
  const Quat q(0.54877638328173595, 0.39432706887914976, -0.72814953885221023, -0.11466862243311844);
  const Pose X_AB{q, Vec3(1.1135359739179205, 0.26249457031370227, 0.48089344467414413)};
  const Cylinder a{0.274918855530559, 0.57143989704423781}, b{0.41129241836616681, 0.77562716994110414};
  EXPECT_LE(missed_separation(a, b, X_AB), 1e-12);  // 0; was 1.1e-6
}

// The same 0.25 rad beside a ridge, which a search from next to it had led back to. Found among 100 000 poses.
TEST(Curved, SeesTheWayOutThatTheRidgeDrawsFrom) {
  const Quat q(-0.082614045860466848, -0.14083086762575828, -0.15857615982984349, -0.97375314514714706);
  const Pose X_AB{q, Vec3(0.019876699193935251, -0.1084785611969884, 0.084740078920102477)};
  const Cylinder cylinder{0.34359725745898828, 0.32226175956161424};
  const Ellipsoid plate{Vec3(0.0017990265085185866, 0.58126514226920634, 0.36481728406086811)};
  EXPECT_LE(missed_separation(cylinder, plate, X_AB), 1e-12);  // 0; was 4.8e-3
}

// Two optima 0.14 to 0.25 rad apart, narrow both, with a wide top between them: thin shapes. Each found among 100 000 poses.
TEST(Curved, SeesPastTheTopBetweenTwoWaysOut) {
  const Quat q_cone(-0.0046468398632434644, -0.93039787330598223, -0.091069230816827496, 0.35502760375134529);
  const Vec3 p_cone(0.056946952174293838, 0.012612039068362009, 0.018472796568929618);
  const Ellipsoid needle{Vec3(0.0015343384038342183, 0.0035830987025093743, 0.44129577411242737)};
  EXPECT_LE(missed_separation(Cone{0.26814696830611667, 0.15284149004786035}, needle, {q_cone, p_cone}),
            1e-12);  // 0; was 1.8e-3

  const Quat q_thin(0.84075074880215417, 0.13594228181129148, 0.52375839446736261, -0.018303514130542202);
  const Vec3 p_thin(0.63753780652068748, 0.029848617414926441, -0.082472934790805474);
  const Ellipsoid plate{Vec3(0.7769493262038405, 0.004240235945384396, 0.15315440036218997)},
      rod{Vec3(0.0012823822026487132, 0.0021985557651905173, 0.14848169440607861)};
  EXPECT_LE(missed_separation(plate, rod, {q_thin, p_thin}), 1e-12);  // 0; was 2.9e-5

  const Quat q_flat(-0.66788324153944101, 0.53026519969471164, 0.086970717917531179, 0.51496299662053924);
  const Vec3 p_flat(-0.018867178917760182, -0.022141792102611052, 0.068379812933855991);
  const Cone flat{0.039887736742556676, 0.0020699275208368433},
      flatter{0.072375793988281895, 0.0022379538635867134};
  EXPECT_LE(missed_separation(flat, flatter, {q_flat, p_flat}), 1e-12);  // 0; was 5.8e-9
}

TEST(Curved, AMillimetreAndAKilometreAreTheSame) {
  RandomPose random(81);
  const auto scaled = [](const Shape& shape, double s) -> Shape {
    if (const auto* c = std::get_if<Cylinder>(&shape)) return Cylinder{s * c->radius, s * c->half_length};
    if (const auto* c = std::get_if<Cone>(&shape)) return Cone{s * c->radius, s * c->half_length};
    if (const auto* b = std::get_if<Box>(&shape)) return Box{s * b->half_extents};
    return Ellipsoid{s * std::get_if<Ellipsoid>(&shape)->half_axes};
  };
  for (int i = 0; i < 400; ++i) {
    const std::array<std::size_t, 4> types = {2, 4, 5, 6};
    const Shape a = random_shape(random, types[static_cast<std::size_t>(i % 4)], 0.2);
    const Shape b = random_shape(random, types[static_cast<std::size_t>(1 + i / 4 % 3)], 0.2);
    const Pose X_AB = place(random, a, b, i % 2 ? Overlap::shallow : Overlap::deep);
    const Manifold m = query(a, {}, b, X_AB, 0.0);
    for (const double s : {0x1p-10, 0x1p+10}) {  // powers of two: not a bit may differ
      const Manifold other = query(scaled(a, s), {}, scaled(b, s), {X_AB.q, s * X_AB.p}, 0.0);
      ASSERT_EQ(m.count, other.count);
      ASSERT_EQ(m.normal_A, other.normal_A);
      for (std::size_t k = 0; k < static_cast<std::size_t>(m.count); ++k) {
        ASSERT_EQ(s * m.points[k].separation, other.points[k].separation);
        ASSERT_EQ(s * m.points[k].p_A, other.points[k].p_A);
      }
    }
  }
}

TEST(Curved, SwappedPairsOfOneTypeAreMirroredToTheBit) {
  RandomPose random(82);
  for (int i = 0; i < 600; ++i) {
    const std::size_t type = static_cast<std::size_t>(4 + i % 3);
    const Shape a = random_shape(random, type, 0.2), b = random_shape(random, type, 0.2);
    const Pose X_WA = random.pose(1.0),
               X_WB = X_WA * place(random, a, b, i % 2 ? Overlap::shallow : Overlap::deep);
    Manifold m = query(a, X_WA, b, X_WB, 0.01);
    const Manifold mirrored = query(b, X_WB, a, X_WA, 0.01);
    ASSERT_EQ(m.count, mirrored.count);
    // One of the two is computed and the other turned round: which one, the shapes decide.
    Manifold turned = mirrored;
    swap_shapes(turned, relative_pose(X_WB, X_WA));
    Manifold back = m;
    swap_shapes(back, relative_pose(X_WA, X_WB));
    ASSERT_TRUE(turned.normal_A == m.normal_A || back.normal_A == mirrored.normal_A);
    for (std::size_t k = 0; k < static_cast<std::size_t>(m.count); ++k) {
      ASSERT_EQ(m.points[k].separation, mirrored.points[k].separation);
      ASSERT_EQ(m.points[k].feature, mirrored.points[k].feature);
    }
  }
}

TEST(Curved, DegeneratePosesAreFinite) {
  RandomPose random(83);
  for (std::size_t type_a = 0; type_a < 7; ++type_a) {
    for (std::size_t type_b = 4; type_b < 7; ++type_b) {
      for (const double least : {0.5, 1e-3}) {
        const Shape a = random_shape(random, type_a, least), b = random_shape(random, type_b, least);
        const double r = bounding_radius(b);
        for (const Vec3& p :
             {Vec3(0, 0, 0), Vec3(1e-300, 0, 0), Vec3(0, 0, r), Vec3(r, 0, 0), Vec3(0, 1e-12, r)}) {
          for (const Quat& q :
               {turn(Vec3::UnitX(), 0.0), turn(Vec3::UnitX(), kQuarter), turn(Vec3::UnitY(), 1e-9)}) {
            const Manifold m = query(a, {}, b, {q, p}, 0.01);
            ASSERT_NEAR(m.normal_A.norm(), 1.0, 1e-13);
            for (std::size_t k = 0; k < static_cast<std::size_t>(m.count); ++k) {
              ASSERT_TRUE(m.points[k].p_A.allFinite() && std::isfinite(m.points[k].separation))
                  << shape_name(a) << ' ' << shape_name(b);
            }
          }
        }
      }
    }
  }
}

// Contacts of several points ------------------------------------------------------------------------------------------

TEST(CurvedManifold, AnUprightCylinderStandsOnEightPoints) {
  const Cylinder cylinder{0.3, 0.5};
  for (const double tilt : {0.0, 1e-9, 1e-7}) {
    const Pose X_WB{turn(Vec3::UnitX(), tilt), Vec3(0.1, -0.2, 1.0 - 1e-4)};
    for (const Shape& ground : {Shape(Box{Vec3(2, 2, 0.5)}), Shape(Cylinder{3.0, 0.5})}) {
      const Manifold m = query(ground, {}, cylinder, X_WB, 0.01);
      ASSERT_EQ(m.count, 8) << shape_name(ground) << tilt;
      const double lowest = X_WB.p.z() - 0.5 * std::cos(tilt) - 0.3 * std::sin(tilt);
      EXPECT_NEAR(least_separation(m), lowest - 0.5, 1e-15);
      Vec3 middle = Vec3::Zero();
      for (const ManifoldPoint& point : m.points) {
        EXPECT_NEAR((point.p_A - Vec3(0.1, -0.2, 0.5)).head<2>().norm(), 0.3, 1e-6);
        middle += point.p_A / 8;
      }
      EXPECT_NEAR((middle - Vec3(0.1, -0.2, 0.5)).head<2>().norm(), 0.0, 1e-6);
    }
  }
}

TEST(CurvedManifold, ALyingCylinderTouchesInItsTwoEnds) {
  const Pose lying{turn(Vec3::UnitX(), kQuarter), Vec3(0, 0, 0.3 - 1e-5)};
  const Pose box{Quat::Identity(), Vec3(0, 0, -1)};
  for (const Manifold& m : {query(HalfSpace{}, {}, Cylinder{0.3, 0.5}, lying, 0.0),
                            query(Box{Vec3(2, 2, 1)}, box, Cylinder{0.3, 0.5}, lying, 0.0)}) {
    ASSERT_EQ(m.count, 2);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_NEAR(m.points[k].separation, -1e-5, 1e-15);
      EXPECT_NEAR(std::abs(m.points[k].p_A.y()), 0.5, 1e-12);
    }
  }
}

TEST(CurvedManifold, CylindersSideBySideTouchAlongTheirCommonPart) {
  const Manifold m =
      query(Cylinder{0.3, 1.0}, {}, Cylinder{0.2, 1.0}, {Quat::Identity(), Vec3(0.5 - 1e-4, 0, 0.6)}, 0.0);
  ASSERT_EQ(m.count, 2);
  EXPECT_LE((m.normal_A - Vec3::UnitX()).norm(), 1e-12);
  const double low = std::min(m.points[0].p_A.z(), m.points[1].p_A.z());
  const double high = std::max(m.points[0].p_A.z(), m.points[1].p_A.z());
  EXPECT_NEAR(low, -0.4, 1e-12);
  EXPECT_NEAR(high, 1.0, 1e-12);
}

TEST(CurvedManifold, AConeStandsOnItsBaseAndLiesOnItsSide) {
  const Cone cone{0.3, 0.4};
  EXPECT_EQ(query(HalfSpace{}, {}, cone, {Quat::Identity(), Vec3(0, 0, 0.4 - 1e-5)}, 0.0).count, 8);
  // The side's normal is (2l, r) in the half-plane of the axis: it looks down after this turn.
  const double angle = std::atan2(0.8, 0.3);
  const Quat q = turn(Vec3::UnitY(), kQuarter + (kQuarter - angle));
  const double height = -(q * support(cone, q.conjugate() * -Vec3::UnitZ())).z();
  const Manifold m = query(HalfSpace{}, {}, cone, {q, Vec3(0, 0, height - 1e-5)}, 1e-4);
  ASSERT_EQ(m.count, 2);
  EXPECT_NEAR((m.points[0].p_A - m.points[1].p_A).norm(), std::sqrt(0.8 * 0.8 + 0.3 * 0.3), 1e-4);
}

TEST(CurvedManifold, NamesSurviveSmallMotion) {
  RandomPose random(84);
  const Box box{Vec3(1, 1, 0.5)};
  const Cylinder cylinder{0.3, 0.5};
  const Manifold first = query(box, {}, cylinder, {Quat::Identity(), Vec3(0, 0, 1.0)}, 0.01);
  for (int i = 0; i < 200; ++i) {
    const Vec3 axis = random.direction(), shift = random.direction();
    const Pose X{turn(axis, 1e-7), Vec3(0, 0, 1.0) + 1e-7 * shift};
    const Manifold m = query(box, {}, cylinder, X, 0.01);
    ASSERT_EQ(m.count, first.count);
    for (std::size_t k = 0; k < static_cast<std::size_t>(m.count); ++k) {
      EXPECT_EQ(m.points[k].feature, first.points[k].feature);
      EXPECT_LE((m.points[k].p_A - first.points[k].p_A).norm(), 1e-6);
    }
  }
}

}  // namespace
}  // namespace tumble::test
