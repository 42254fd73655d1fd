// Mass, centre and inertia: each closed form against integration by slices, and against each other.
#include "dynamics/mass_properties.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "math/rotation.h"

namespace tumble {
namespace {

using std::numbers::pi;

double distance(const Inertia& a, const Inertia& b) {
  const double scale = b.moments.cwiseAbs().maxCoeff();
  const double length = std::sqrt(scale / b.mass);
  return std::max({std::abs(a.mass / b.mass - 1.0), (a.center - b.center).norm() / length,
                   (a.moments - b.moments).cwiseAbs().maxCoeff() / scale});
}

/// Solid of revolution about z as a stack of thin discs of radius profile(z) at the middles of slices.
Inertia by_slices(double bottom, double top, double density, const std::function<double(double)>& profile) {
  constexpr int kSlices = 20000;
  const double dz = (top - bottom) / kSlices;
  Inertia sum;
  for (int i = 0; i < kSlices; ++i) {
    const double z = bottom + (i + 0.5) * dz;
    const double r2 = profile(z) * profile(z);
    const double m = density * pi * r2 * dz;
    sum.mass += m;
    sum.moments += m * Vec3(r2 / 4 + z * z, r2 / 4 + z * z, r2 / 2).asDiagonal().toDenseMatrix();
  }
  return sum;
}

/// Of density 1, from points thrown into the box with these half extents.
Inertia by_chance(const Vec3& half, const std::function<bool(const Vec3&)>& is_inside) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  constexpr int kPoints = 400000;
  double inside = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (int i = 0; i < kPoints; ++i) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = half[k] * uniform(random);
    if (!is_inside(p)) continue;
    inside += 1.0;
    first += p;
    second += p * p.transpose();
  }
  Inertia sampled;
  sampled.mass = inside / kPoints * 8.0 * half.prod();
  sampled.center = first / inside;
  const Mat3 C = sampled.mass * (second / inside - sampled.center * sampled.center.transpose());
  sampled.moments = C.trace() * Mat3::Identity() - C;
  return sampled;
}

/// Made by hand, so that this test does not lean on the hull builder.
ConvexHull::Parts box_hull(const Vec3& h) {
  ConvexHull::Parts hull;
  for (int i = 0; i < 8; ++i) {
    hull.vertices.push_back(h.cwiseProduct(Vec3(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0)));
  }
  hull.loops = {0, 4, 6, 2, 1, 3, 7, 5, 0, 1, 5, 4, 2, 6, 7, 3, 0, 2, 3, 1, 4, 5, 7, 6};
  for (std::uint32_t f = 0; f < 6; ++f) hull.faces.push_back({Vec3::Zero(), 0.0, 4 * f, 4});
  return hull;
}

Inertia hull_inertia(const ConvexHull::Parts& hull, double density) {
  return compute_inertia(std::make_shared<const ConvexHull>(hull), density);
}

Quat random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Quat q;
  for (int i = 0; i < 4; ++i) q.coeffs()[i] = normal(random);
  return normalized(q);
}

TEST(MassProperties, SphereEqualsItsSlices) {
  const double r = 0.7;
  const Inertia slices = by_slices(-r, r, 900.0, [&](double z) { return std::sqrt(r * r - z * z); });
  EXPECT_LT(distance(compute_inertia(Sphere{r}, 900.0), slices), 1e-8);  // measured 3.1e-9, of the slices
}

TEST(MassProperties, CapsuleEqualsItsSlices) {
  const double r = 0.3, l = 0.8;
  const Inertia slices = by_slices(-l - r, l + r, 1100.0, [&](double z) {
    const double beyond = std::max(0.0, std::abs(z) - l);
    return std::sqrt(r * r - beyond * beyond);
  });
  EXPECT_LT(distance(compute_inertia(Capsule{r, l}, 1100.0), slices),
            5e-8);  // measured 1.1e-8, of the slices
}

TEST(MassProperties, CapsuleOfNoLengthIsASphereAndOfGreatLengthACylinder) {
  EXPECT_LT(distance(compute_inertia(Capsule{0.4, 1e-300}, 1000.0), compute_inertia(Sphere{0.4}, 1000.0)),
            1e-15);
  const double r = 1e-9, l = 1.0;
  const Inertia thin = compute_inertia(Capsule{r, l}, 1000.0);
  EXPECT_NEAR(thin.moments(0, 0) / (thin.mass * l * l / 3.0), 1.0, 5e-9);  // rod: m (2l)^2 / 12
  EXPECT_NEAR(thin.moments(2, 2) / (thin.mass * r * r / 2.0), 1.0, 5e-9);
}

TEST(MassProperties, CylinderConeAndEllipsoidEqualTheirSlices) {
  const double r = 0.3, l = 0.8;
  const auto slices = [&](const std::function<double(double)>& profile) {
    Inertia sum = by_slices(-l, l, 1100.0, profile);
    return sum;
  };
  EXPECT_LT(distance(compute_inertia(Cylinder{r, l}, 1100.0), slices([&](double) { return r; })),
            5e-9);  // measured 2.2e-9, of the slices
  // The cone's slices are about its frame's origin; its own moments are about its centre, l/2 below.
  Inertia cone = compute_inertia(Cone{r, l}, 1100.0);
  EXPECT_EQ(cone.center, Vec3(0, 0, -0.5 * l));
  const double shift = cone.mass * 0.25 * l * l;
  cone.moments(0, 0) += shift;
  cone.moments(1, 1) += shift;
  cone.center.setZero();
  EXPECT_LT(distance(cone, slices([&](double z) { return 0.5 * r * (1.0 - z / l); })),
            5e-8);  // measured 1.3e-8
  EXPECT_LT(distance(compute_inertia(Ellipsoid{Vec3(r, r, l)}, 1100.0),
                     slices([&](double z) { return r * std::sqrt(1.0 - z * z / (l * l)); })),
            5e-8);
}

/// Points of the unit shape's mesh, `n` around and `n` / 2 along; finer meshes nest their error as 1/n^2.
std::vector<Vec3> sample_surface(int n, bool ellipsoid, double taper) {
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) {
    const double turn = 2.0 * pi * i / n, x = std::cos(turn), y = std::sin(turn);
    if (!ellipsoid) {
      points.emplace_back(x, y, -1.0);
      if (taper > 0.0) points.emplace_back(taper * x, taper * y, 1.0);
      continue;
    }
    for (int j = 1; j < n / 2; ++j) {
      const double rise = -0.5 * pi + 2.0 * pi * j / n;
      points.emplace_back(x * std::cos(rise), y * std::cos(rise), std::sin(rise));
    }
  }
  if (ellipsoid) points.emplace_back(0, 0, -1);
  if (ellipsoid || taper == 0.0) points.emplace_back(0, 0, 1);
  return points;
}

TEST(MassProperties, FineHullsConvergeToTheCurvedShapesInSecondOrder) {
  const Vec3 size(0.4, 0.4, 0.7);
  const auto error = [&](const Shape& shape, int n, bool ellipsoid, double taper) {
    std::vector<Vec3> points = sample_surface(n, ellipsoid, taper);
    for (Vec3& p : points) p = p.cwiseProduct(size);
    const HullPointer hull = std::make_shared<const ConvexHull>(build_convex_hull(points));
    return distance(compute_inertia(hull, 1.0), compute_inertia(shape, 1.0));
  };
  const auto order = [&](const Shape& shape, bool ellipsoid, double taper) {
    return std::log2(error(shape, 16, ellipsoid, taper) / error(shape, 32, ellipsoid, taper));
  };
  EXPECT_NEAR(order(Cylinder{0.4, 0.7}, false, 1.0), 2.0, 0.05);
  EXPECT_NEAR(order(Cone{0.4, 0.7}, false, 0.0), 2.0, 0.05);
  EXPECT_NEAR(order(Ellipsoid{size}, true, 0.0), 2.0, 0.05);
}

TEST(MassProperties, BoxAsHullEqualsBox) {
  const Vec3 h(0.3, 0.5, 1.1);
  EXPECT_LT(distance(hull_inertia(box_hull(h), 700.0), compute_inertia(Box{h}, 700.0)),
            1e-14);  // measured 5e-16
}

TEST(MassProperties, AHullTurnedAndFarAwayEqualsTheTransformedBox) {
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    const Vec3 h(0.3, 0.5, 1.1);
    const Pose X{random_rotation(random), Vec3(10.0 * i, -3.0, 7.0)};
    ConvexHull::Parts hull = box_hull(h);
    for (Vec3& vertex : hull.vertices) vertex = X * vertex;
    // The vertices themselves are rounded to 1e-16 of 200 m; measured 2.2e-14.
    EXPECT_LT(distance(hull_inertia(hull, 700.0), transformed(compute_inertia(Box{h}, 700.0), X)), 1e-12);
  }
}

TEST(MassProperties, CornerTetrahedronHasItsKnownIntegrals) {
  ConvexHull::Parts hull;
  hull.vertices = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  hull.loops = {0, 2, 1, 0, 3, 2, 0, 1, 3, 1, 2, 3};
  for (std::uint32_t f = 0; f < 4; ++f) hull.faces.push_back({Vec3::Zero(), 0.0, 3 * f, 3});
  const Inertia tetrahedron = hull_inertia(hull, 1.0);
  EXPECT_NEAR(tetrahedron.mass, 1.0 / 6.0, 1e-16);
  EXPECT_LT((tetrahedron.center - Vec3::Constant(0.25)).norm(), 1e-15);
  // int x^2 = 1/60 and int x y = 1/120 about the corner; less V/16 each about the centre.
  const double diagonal = 2.0 * (1.0 / 60.0 - 1.0 / 96.0), mixed = -(1.0 / 120.0 - 1.0 / 96.0);
  Mat3 expected = Mat3::Constant(mixed);
  expected.diagonal().setConstant(diagonal);
  EXPECT_LT((tetrahedron.moments - expected).cwiseAbs().maxCoeff(), 1e-16);
}

TEST(MassProperties, AnIrregularHullEqualsMonteCarlo) {
  // A box sheared and tapered: still convex with planar faces.
  ConvexHull::Parts hull = box_hull(Vec3(0.5, 0.4, 0.6));
  for (Vec3& v : hull.vertices) {
    if (v.z() > 0) v = Vec3(0.5 * v.x() + 0.2, 0.5 * v.y() - 0.1, v.z());
  }
  const Inertia exact = hull_inertia(hull, 1.0);
  const Inertia sampled = by_chance({1.0, 1.0, 0.6}, [](const Vec3& p) {
    const double t = (p.z() + 0.6) / 1.2, scale = 1.0 - 0.5 * t;  // cross-section at height z
    return std::abs(p.x() - 0.2 * t) <= 0.5 * scale && std::abs(p.y() + 0.1 * t) <= 0.4 * scale;
  });
  EXPECT_LT(distance(sampled, exact), 1.5e-2);  // measured 5.5e-3, statistical
}

TEST(MassProperties, RoundShapesEqualMonteCarlo) {
  const double r = 0.4, h = 0.6;
  const Vec3 axes(0.3, 0.5, 0.4);
  const auto across = [](const Vec3& p) { return std::sqrt(p.x() * p.x() + p.y() * p.y()); };
  const Inertia sphere = by_chance({r, r, r}, [&](const Vec3& p) { return p.norm() <= r; });
  const Inertia capsule = by_chance(
      {r, r, h + r}, [&](const Vec3& p) { return (p - Vec3(0, 0, std::clamp(p.z(), -h, h))).norm() <= r; });
  const Inertia cylinder = by_chance({r, r, h}, [&](const Vec3& p) { return across(p) <= r; });
  const Inertia cone =
      by_chance({r, r, h}, [&](const Vec3& p) { return across(p) <= r * (h - p.z()) / (2 * h); });
  const Inertia ellipsoid =
      by_chance(axes, [&](const Vec3& p) { return p.cwiseQuotient(axes).norm() <= 1.0; });
  // Measured 0.6e-3 to 4e-3, statistical.
  EXPECT_LT(distance(sphere, compute_inertia(Sphere{r}, 1.0)), 1.5e-2);
  EXPECT_LT(distance(capsule, compute_inertia(Capsule{r, h}, 1.0)), 1.5e-2);
  EXPECT_LT(distance(cylinder, compute_inertia(Cylinder{r, h}, 1.0)), 1.5e-2);
  EXPECT_LT(distance(cone, compute_inertia(Cone{r, h}, 1.0)), 1.5e-2);
  EXPECT_LT(distance(ellipsoid, compute_inertia(Ellipsoid{axes}, 1.0)), 1.5e-2);
}

TEST(MassProperties, EightSmallBoxesMakeTheBigBox) {
  const Vec3 h(0.3, 0.5, 1.1);
  std::vector<Inertia> parts;
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
    parts.push_back(
        transformed(compute_inertia(Box{0.5 * h}, 500.0), {Quat::Identity(), corner.cwiseProduct(h)}));
  }
  EXPECT_LT(distance(combined(parts), compute_inertia(Box{h}, 500.0)), 1e-15);
}

TEST(MassProperties, ParallelAxes) {
  // Two balls of mass m at +-a on x: I_yy = 2 (2/5 m r^2 + m a^2).
  const Inertia ball = compute_inertia(Sphere{0.2}, 1000.0);
  const Inertia dumbbell = combined({transformed(ball, {Quat::Identity(), Vec3(1.5, 0, 0)}),
                                     transformed(ball, {Quat::Identity(), Vec3(-1.5, 0, 0)})});
  EXPECT_NEAR(dumbbell.moments(0, 0), 2.0 * 0.4 * ball.mass * 0.04, 1e-14);
  EXPECT_NEAR(dumbbell.moments(1, 1) / (2.0 * ball.mass * (0.4 * 0.04 + 2.25)), 1.0, 1e-15);
  EXPECT_EQ(dumbbell.center, Vec3::Zero());
}

TEST(MassProperties, OnePartIsItselfToTheBit) {
  std::mt19937 random(3);
  const Inertia part = transformed(compute_inertia(Box{Vec3(0.1, 0.2, 0.3)}, 777.0),
                                   {random_rotation(random), Vec3(0.1, 0.2, 0.3)});
  const Inertia whole = combined({part});
  EXPECT_EQ(whole.mass, part.mass);
  EXPECT_EQ(whole.center, part.center);
  EXPECT_EQ(whole.moments, part.moments);
}

TEST(MassProperties, ABodyOfNoPartsAndAHalfSpaceAreRefused) {
  EXPECT_THROW(combined({}), std::invalid_argument);
  EXPECT_THROW(compute_inertia(HalfSpace{}, 1000.0), std::invalid_argument);
}

TEST(MassProperties, PrincipalAxesOfADiagonalTensorAreExactlyTheBodys) {
  const Inertia box = compute_inertia(Box{Vec3(0.3, 1.1, 0.5)}, 700.0);
  const MassProperties properties = compute_mass_properties(box);
  EXPECT_EQ(properties.q_BP.coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(properties.I, Vec3(box.moments.diagonal()));
  EXPECT_EQ(properties.mass, box.mass);
  EXPECT_EQ(properties.inv_mass, 1.0 / box.mass);
}

TEST(MassProperties, PrincipalAxesRebuildTheTensor) {
  std::mt19937 random(4);
  for (const Vec3& h : {Vec3(0.3, 0.5, 1.1), Vec3(0.001, 0.5, 0.5), Vec3(1, 1, 1), Vec3(1, 1, 1.0000001)}) {
    for (int i = 0; i < 100; ++i) {
      const Quat q_FS = random_rotation(random);
      const Inertia box = compute_inertia(Box{h}, 700.0);
      const Inertia turned = transformed(box, {q_FS, Vec3::Zero()});
      const MassProperties properties = compute_mass_properties(turned);
      const Mat3 R = rotation_matrix(properties.q_BP);
      const double scale = turned.moments.cwiseAbs().maxCoeff();
      EXPECT_LT((R * properties.I.asDiagonal() * R.transpose() - turned.moments).norm(), 5e-15 * scale);
      EXPECT_LT((R.transpose() * R - Mat3::Identity()).norm(), 2e-15);
      EXPECT_NEAR(R.determinant(), 1.0, 2e-15);
      Vec3 found = properties.I, expected = box.moments.diagonal();
      std::sort(found.data(), found.data() + 3);
      std::sort(expected.data(), expected.data() + 3);
      EXPECT_LT((found - expected).norm(), 5e-15 * scale);
    }
  }
}

TEST(MassProperties, ASoundInertiaIsAccepted) {
  for (const Shape& shape : {Shape(Sphere{0.1}), Shape(Box{Vec3(1e-3, 1, 1)}), Shape(Capsule{0.01, 2.0})}) {
    EXPECT_EQ(check_inertia(compute_inertia(shape, 1000.0)), "");
  }
  Inertia plate;  // a flat plate lies exactly on the border of the triangle inequality
  plate.mass = 1.0;
  plate.moments = Vec3(1.0, 2.0, 3.0).asDiagonal();
  EXPECT_EQ(check_inertia(plate), "");
}

TEST(MassProperties, AnImpossibleInertiaIsRefusedWithItsValues) {
  const Inertia good = compute_inertia(Sphere{1.0}, 1.0);
  const auto reason = [&](auto change) {
    Inertia bad = good;
    change(bad);
    return check_inertia(bad);
  };
  const double nan = std::nan("");
  EXPECT_EQ(reason([](Inertia& i) { i.mass = -2.5; }), "mass: must be > 0 and finite (-2.5)");
  EXPECT_EQ(reason([&](Inertia& i) { i.mass = nan; }), "mass: must be > 0 and finite (nan)");
  EXPECT_EQ(reason([](Inertia& i) { i.mass = 1e-310; }), "mass: must be > 0 and finite (1e-310)");
  EXPECT_EQ(reason([&](Inertia& i) { i.center.y() = nan; }), "center: must be finite (0 nan 0)");
  EXPECT_NE(reason([&](Inertia& i) { i.moments(0, 1) = nan; }).find("moments: must be finite"),
            std::string::npos);
  EXPECT_NE(reason([](Inertia& i) { i.moments(0, 2) = 0.1; }).find("symmetric (xz 0.1, zx 0)"),
            std::string::npos);
  EXPECT_NE(reason([](Inertia& i) { i.moments.setZero(); }).find("positive definite"), std::string::npos);
  EXPECT_NE(reason([](Inertia& i) { i.moments = Vec3(1, 1, -1).asDiagonal(); }).find("positive definite"),
            std::string::npos);
  EXPECT_NE(reason([](Inertia& i) {
              i.moments = Vec3(1, 2, 3.1).asDiagonal();
            }).find("(principal moments 1 2 3.1)"),
            std::string::npos);
}

TEST(MassProperties, WorldInertiaOfABallIsExactlyTheSameFromEverySide) {
  std::mt19937 random(5);
  const MassProperties ball = compute_mass_properties(compute_inertia(Sphere{0.3}, 1000.0));
  const Mat3 expected = ball.I.x() * Mat3::Identity();
  EXPECT_EQ(world_inertia(ball.I, ball.q_BP, random_rotation(random)), expected);
}

}  // namespace
}  // namespace tumble
