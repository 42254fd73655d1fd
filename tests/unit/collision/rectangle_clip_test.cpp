// Reference: the same polygon cut side by side (Sutherland and Hodgman), in long double.
#include "collision/rectangle_clip.h"

#include <gtest/gtest.h>

#include <vector>

#include "random_pose.h"

namespace tumble::test {
namespace {

using Point = Eigen::Matrix<long double, 3, 1>;

std::vector<Point> cut(const std::vector<Point>& polygon, int axis, long double sign, long double limit) {
  std::vector<Point> left;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const long double outside = sign * p[axis] - limit, next = sign * q[axis] - limit;
    if (outside <= 0) left.push_back(p);
    if ((outside <= 0) != (next <= 0)) left.push_back(p + outside / (outside - next) * (q - p));
  }
  return left;
}

std::vector<Point> clip_exactly(const Parallelogram& p, double h1, double h2) {
  const Point m = p.m.cast<long double>(), e1 = p.e1.cast<long double>(), e2 = p.e2.cast<long double>();
  std::vector<Point> polygon = {m - e1 - e2, m + e1 - e2, m + e1 + e2, m - e1 + e2};
  for (const long double sign : {1.0L, -1.0L}) polygon = cut(cut(polygon, 0, sign, h1), 1, sign, h2);
  return polygon;
}

std::vector<Vec3> corners_of(const RectangleClip& clip) {
  std::vector<Vec3> corners;
  const RectangleClip::Set set = clip.corners_below(kInfinity);
  for (std::size_t i = 0; i < 16; ++i) {
    const FourVectors& places = clip.places[i / 4];
    if (set >> i & 1) corners.emplace_back(places.x[i % 4], places.y[i % 4], places.z[i % 4]);
  }
  return corners;
}

/// How far the furthest of `points` is from its nearest of `others`.
template <typename Points, typename Others>
double distance_from(const Points& points, const Others& others) {
  double furthest = 0.0;
  for (const auto& p : points) {
    double nearest = kInfinity;
    for (const auto& q : others)
      nearest = std::min(nearest, (p.template cast<double>() - q.template cast<double>()).norm());
    furthest = std::max(furthest, nearest);
  }
  return furthest;
}

/// As boxes' faces lie over each other: turned, tilted by up to `tilt` [rad], as large as each other, ten times or a tenth.
Parallelogram face_over(RandomPose& random, double tilt) {
  const double yaw = random.uniform(-3.2, 3.2), a = random.log_uniform(0.1, 10.0),
               b = random.log_uniform(0.1, 10.0);
  const double c = std::cos(yaw), s = std::sin(yaw);
  return {random.vector(-1.5, 1.5), a * Vec3(c, s, random.uniform(-tilt, tilt)),
          b * Vec3(-s, c, random.uniform(-tilt, tilt))};
}

TEST(RectangleClip, LeavesWhatCuttingSideBySideLeaves) {
  RandomPose random(7);
  double worst = 0.0;
  std::array<int, 9> of_count{};
  for (int i = 0; i < 100000; ++i) {
    const Parallelogram p = face_over(random, 0.7);
    const double h1 = random.log_uniform(0.3, 3.0), h2 = random.log_uniform(0.3, 3.0);
    const std::vector<Point> expected = clip_exactly(p, h1, h2);
    const std::vector<Vec3> found = corners_of(RectangleClip(p, h1, h2, 0.0));
    ASSERT_EQ(found.size(), expected.size()) << i;
    ++of_count[found.size()];
    worst = std::max({worst, distance_from(expected, found), distance_from(found, expected)});
  }
  EXPECT_LT(worst, 1e-12);  // 7e-14 [m]: sides that are cut at a small angle
  for (const std::size_t count : {0u, 3u, 4u, 5u, 6u, 7u, 8u}) EXPECT_GT(of_count[count], 10) << count;
}

/// Sides and corners that coincide or are closer than the tolerance: every corner of what is left has a place no further
/// away than that, and no two places are one.
TEST(RectangleClip, CoincidingSidesMakeNoDoubles) {
  RandomPose random(8);
  constexpr double kTolerance = 1e-4;
  const auto nearly = [&](double x) {
    return x + random.uniform(-0.3, 0.3) * kTolerance * (random.uniform(0, 1) < 0.5);
  };
  int cases = 0;
  for (int i = 0; i < 20000; ++i) {
    // Edges along the sides, from one of their ends or beyond to another place of either kind.
    const auto end = [&](double h) { return nearly(h * std::floor(random.uniform(-2.0, 3.0))); };
    const double x1 = end(1.0), x2 = end(1.0), y1 = end(0.5), y2 = end(0.5);
    const auto common = [](double from, double to, double h) {
      return std::min(std::max(from, to), h) - std::max(std::min(from, to), -h);
    };
    if (common(x1, x2, 1.0) < 0.1 || common(y1, y2, 0.5) < 0.1) continue;  // apart, or a sliver
    ++cases;
    const Parallelogram p = {{0.5 * (x1 + x2), 0.5 * (y1 + y2), 0.0},
                             {0.5 * std::abs(x2 - x1), 0.0, 0.0},
                             {0.0, 0.5 * std::abs(y2 - y1), 0.0}};
    const std::vector<Vec3> found = corners_of(RectangleClip(p, 1.0, 0.5, kTolerance));
    const std::vector<Point> expected = clip_exactly(p, 1.0, 0.5);
    EXPECT_LE(distance_from(expected, found), 2.0 * kTolerance) << i;
    for (std::size_t j = 0; j < found.size(); ++j) {
      for (std::size_t k = 0; k < j; ++k) EXPECT_GT((found[j] - found[k]).norm(), 0.01) << i;
    }
  }
  EXPECT_GT(cases, 1000);
}

TEST(RectangleClip, NamesTheSideThatIsCrossed) {
  // A strip along x over the whole rectangle: its long edges come in on one side and leave by the other.
  const RectangleClip clip({{0.0, 0.0, 0.1}, {5.0, 0.0, 0.0}, {0.0, 0.2, 0.0}}, 1.0, 0.5, 0.0);
  EXPECT_EQ(clip.corners_below(kInfinity), 0b0000'0101'0101'0000u);
  EXPECT_EQ(clip.corners_below(0.05), 0u);
  EXPECT_EQ(clip.on[RectangleClip::entry][0], 2);
  EXPECT_EQ(clip.on[RectangleClip::exit][0], 0);
  EXPECT_EQ(clip.on[RectangleClip::entry][2], 0);
  EXPECT_EQ(clip.on[RectangleClip::exit][2], 2);
}

}  // namespace
}  // namespace tumble::test
