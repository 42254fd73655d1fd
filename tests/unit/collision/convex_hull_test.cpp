// A hull is a closed convex polyhedron: Euler's formula, every point behind every face, loops that turn left.
#include "collision/convex_hull.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>

#include "math/pose.h"
#include "math/rotation.h"

namespace tumble {
namespace {

std::vector<Vec3> box_corners(const Vec3& h) {
  std::vector<Vec3> points;
  for (int i = 0; i < 8; ++i)
    points.push_back(h.cwiseProduct(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  return points;
}

std::vector<Vec3> turned(std::vector<Vec3> points, const Pose& X) {
  for (Vec3& p : points) p = X * p;
  return points;
}

std::vector<Vec3> prism(int sides, double radius, double half_height) {
  std::vector<Vec3> points;
  for (int i = 0; i < sides; ++i) {
    const double a = 2.0 * std::numbers::pi * i / sides;
    for (const double z : {-half_height, half_height})
      points.emplace_back(radius * std::cos(a), radius * std::sin(a), z);
  }
  return points;
}

double extent_of(const std::vector<Vec3>& points) {
  Vec3 lower = points[0], upper = points[0];
  for (const Vec3& p : points) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  return (upper - lower).maxCoeff();
}

/// Everything that holds for any hull; `flatness` is how far a face's corners may lie behind its plane, of the extent.
void expect_sound(const ConvexHull& hull, const std::vector<Vec3>& points, double flatness) {
  const double extent = extent_of(points);
  ASSERT_EQ(static_cast<long>(hull.vertices.size() + hull.faces.size()),
            static_cast<long>(hull.edges.size()) + 2);
  std::size_t corners = 0;
  for (std::uint32_t f = 0; f < hull.faces.size(); ++f) {
    const Polytope::Face& face = hull.faces[f];
    EXPECT_NEAR(face.normal.norm(), 1.0, 1e-15);
    for (const Vec3& p : points) ASSERT_LE(face.normal.dot(p) - face.offset, 1e-12 * extent);
    ASSERT_GE(face.count, 3u);
    EXPECT_EQ(face.first, corners);
    corners += face.count;
    for (std::uint32_t i = 0; i < face.count; ++i) {
      const Vec3& a = hull.vertices[hull.loops[face.first + i]];
      const Vec3& b = hull.vertices[hull.loops[face.first + (i + 1) % face.count]];
      const Vec3& c = hull.vertices[hull.loops[face.first + (i + 2) % face.count]];
      ASSERT_GE(face.normal.dot(a) - face.offset, -flatness * extent);
      ASSERT_GT(face.normal.dot((b - a).cross(c - b)), 0.0) << "face " << f << " does not turn left";
    }
  }
  EXPECT_EQ(corners, hull.loops.size());
  EXPECT_EQ(corners, 2 * hull.edges.size());
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  for (const Polytope::Edge& edge : hull.edges) {
    EXPECT_LT(edge.tail, edge.head);
    EXPECT_TRUE(seen.insert({edge.tail, edge.head}).second);
    const auto runs = [&](std::uint32_t f, std::uint32_t tail, std::uint32_t head) {
      const Polytope::Face& face = hull.faces[f];
      for (std::uint32_t i = 0; i < face.count; ++i) {
        if (hull.loops[face.first + i] == tail) return hull.loops[face.first + (i + 1) % face.count] == head;
      }
      return false;
    };
    EXPECT_TRUE(runs(edge.left_face, edge.tail, edge.head));
    EXPECT_TRUE(runs(edge.right_face, edge.head, edge.tail));
  }
  ASSERT_EQ(hull.neighbour_offsets.size(), hull.vertices.size() + 1);
  EXPECT_EQ(hull.neighbours.size(), 2 * hull.edges.size());
  for (std::uint32_t v = 0; v < hull.vertices.size(); ++v) {
    for (std::uint32_t i = hull.neighbour_offsets[v]; i < hull.neighbour_offsets[v + 1]; ++i) {
      EXPECT_EQ(seen.count(std::minmax(v, hull.neighbours[i])), 1u);
    }
  }
}

void expect_box(const ConvexHull& hull) {
  EXPECT_EQ(hull.vertices.size(), 8u);
  EXPECT_EQ(hull.faces.size(), 6u);
  EXPECT_EQ(hull.edges.size(), 12u);
}

std::string error_of(const std::vector<Vec3>& points) {
  try {
    build_convex_hull(points);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

Pose random_pose(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Vec3 r, p;
  for (int i = 0; i < 3; ++i) r[i] = normal(random);
  for (int i = 0; i < 3; ++i) p[i] = 10.0 * normal(random);
  return {exp_map(2.0 * r), p};
}

TEST(ConvexHull, OfABoxHasSixFacesAndTwelveEdges) {
  std::mt19937 random(1);
  for (const Vec3& h : {Vec3(1, 1, 1), Vec3(0.1, 2, 30), Vec3(1e-6, 1, 1)}) {
    for (int i = 0; i < 20; ++i) {
      const auto points = turned(box_corners(h), i == 0 ? Pose{} : random_pose(random));
      const ConvexHull hull = build_convex_hull(points);
      expect_box(hull);
      expect_sound(hull, points, 1e-14);
      EXPECT_EQ(hull.parts().vertices, points);  // in the order of the input
    }
  }
}

TEST(ConvexHull, PointsOnFacesEdgesAndInsideChangeNothing) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const Vec3 h(0.5, 1.0, 1.5);
  for (int round = 0; round < 20; ++round) {
    auto points = box_corners(h);
    for (int i = 0; i < 200; ++i) {
      Vec3 p;
      for (int k = 0; k < 3; ++k) p[k] = uniform(random);
      if (i % 3 > 0) p[i / 3 % 3] = i % 2 ? 1.0 : -1.0;            // on a face
      if (i % 3 > 1) p[(i / 3 + 1) % 3] = i % 4 > 1 ? 1.0 : -1.0;  // on an edge
      points.insert(points.begin() + static_cast<long>(random() % points.size()), h.cwiseProduct(p));
    }
    points.insert(points.end(), points.begin(), points.begin() + 50);  // duplicates
    if (round > 0) points = turned(points, random_pose(random));
    const ConvexHull hull = build_convex_hull(points);
    expect_box(hull);
    expect_sound(hull, points, 1e-13);
  }
}

TEST(ConvexHull, CoplanarInSinglePrecisionIsOneFace) {
  std::mt19937 random(3);
  for (int i = 0; i < 20; ++i) {
    auto points = turned(prism(32, 0.5, 0.3), {random_pose(random).q, Vec3::Zero()});
    for (Vec3& p : points) p = p.cast<float>().cast<double>();
    const ConvexHull hull = build_convex_hull(points);
    EXPECT_EQ(hull.faces.size(), 34u);
    expect_sound(hull, points, 4e-7);
  }
}

TEST(ConvexHull, OfAPrismHasItsSides) {
  std::mt19937 random(4);
  for (const int sides : {3, 4, 5, 32, 100}) {
    const auto points = turned(prism(sides, 0.7, 0.2), random_pose(random));
    const ConvexHull hull = build_convex_hull(points);
    EXPECT_EQ(hull.vertices.size(), 2u * sides);
    EXPECT_EQ(hull.faces.size(), 2u + sides);
    EXPECT_EQ(hull.edges.size(), 3u * sides);
    expect_sound(hull, points, 1e-13);
  }
}

TEST(ConvexHull, OfPointsOnASphereKeepsThemAll) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const int count : {4, 5, 10, 100, 1000}) {
    std::vector<Vec3> points;
    for (int i = 0; i < count; ++i) {
      Vec3 p;
      for (int k = 0; k < 3; ++k) p[k] = normal(random);
      points.push_back(p.normalized());
    }
    const ConvexHull hull = build_convex_hull(points);
    EXPECT_EQ(hull.vertices.size(), points.size());
    EXPECT_NEAR(hull.radius, 1.0, 1e-15);
    expect_sound(hull, points, 4e-7);
  }
}

TEST(ConvexHull, OfCloudsSliversAndGridsIsSound) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const Vec3& stretch : {Vec3(1, 1, 1), Vec3(1, 1, 1e-4), Vec3(1, 1e-4, 1e-4), Vec3(1, 1, 1e-7)}) {
    for (int round = 0; round < 20; ++round) {
      std::vector<Vec3> points;
      for (int i = 0; i < 60; ++i) {
        Vec3 p;
        for (int k = 0; k < 3; ++k) p[k] = uniform(random);
        if (round % 2) p = (4.0 * p).array().round() / 4.0;  // many coplanar and collinear
        points.push_back(stretch.cwiseProduct(p));
      }
      points = turned(points, {random_pose(random).q, Vec3::Zero()});
      expect_sound(build_convex_hull(points), points, 4e-7);
    }
  }
}

TEST(ConvexHull, IsTheSameForTheSamePoints) {
  std::mt19937 random(7);
  const auto points = turned(prism(17, 0.7, 0.2), random_pose(random));
  const ConvexHull a = build_convex_hull(points), b = build_convex_hull(points);
  EXPECT_EQ(a.parts().vertices, b.parts().vertices);
  EXPECT_EQ(a.parts().loops, b.parts().loops);
  EXPECT_EQ(a.parts().neighbours, b.parts().neighbours);
  for (std::size_t f = 0; f < a.faces.size(); ++f) EXPECT_EQ(a.faces[f].normal, b.faces[f].normal);
}

TEST(ConvexHull, DoesNotDependOnScale) {
  for (const double scale : {1e-9, 1e-3, 1e9}) {
    auto points = prism(12, 0.7, 0.2);
    for (Vec3& p : points) p *= scale;
    const ConvexHull hull = build_convex_hull(points);
    EXPECT_EQ(hull.faces.size(), 14u);
    expect_sound(hull, points, 1e-13);
  }
}

TEST(ConvexHull, TheLowestVertexIsTheFirstOfEquals) {
  std::mt19937_64 random(5);
  const auto whole = [&] { return static_cast<double>(random() % 3); };  // many are as low as others
  for (std::size_t count = 1; count <= kScannedVertices; ++count) {
    for (int i = 0; i < 50; ++i) {
      std::vector<Vec3> vertices;
      for (std::size_t k = 0; k < count; ++k) vertices.emplace_back(whole(), whole(), whole());
      const Vec3 d(whole() - 1.0, whole() - 1.0, whole() - 1.0);
      const auto lower = [&](const Vec3& v, const Vec3& w) { return d.dot(v) < d.dot(w); };
      const auto first = std::min_element(vertices.begin(), vertices.end(), lower);
      std::vector<FourVectors> fours((count + 3) / 4);
      put_in_fours(vertices, fours.data());
      const Lowest lowest = scan_lowest(fours, d);
      ASSERT_EQ(lowest.vertex, first - vertices.begin()) << count;
      ASSERT_EQ(lowest.height, d.dot(*first));
    }
  }
}

TEST(ConvexHull, NamesWhatIsWrong) {
  EXPECT_EQ(error_of({}), "convex hull: 0 points, at least 4 are needed");
  EXPECT_EQ(error_of(std::vector<Vec3>(10, Vec3::Ones())),
            "convex hull: 1 distinct points, at least 4 are needed");
  auto points = box_corners(Vec3(1, 1, 1));
  points[5].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(error_of(points), "convex hull: point 5 is not finite (1 nan 1)");
  points[5].y() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(error_of(points), "convex hull: point 5 is not finite (1 inf 1)");
  EXPECT_EQ(error_of(prism(8, 1.0, 1e-10)), "convex hull: all points are in one plane");
  EXPECT_EQ(error_of({Vec3(0, 0, 0), Vec3(1, 1, 1), Vec3(2, 2, 2), Vec3(3, 3, 3), Vec3(4, 4, 4)}),
            "convex hull: all points are on one line");
}

}  // namespace
}  // namespace tumble
