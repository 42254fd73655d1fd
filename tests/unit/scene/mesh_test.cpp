// Mesh readers: OBJ, ASCII STL and binary STL give the same points; what is wrong is named with file and line.
#include "scene/mesh.h"

#include <gtest/gtest.h>

#include <bit>

namespace tumble {
namespace {

/// A binary STL of triangles, corner by corner.
std::string binary_stl(const std::vector<Vec3>& corners, std::uint32_t count) {
  std::string bytes(80, ' ');
  bytes.replace(0, 5, "solid");  // as many exporters write it: the word does not tell the formats apart
  const auto word = [&](std::uint32_t w) {
    for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>(w >> (8 * i)));
  };
  word(count);
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    for (int k = 0; k < 3; ++k) word(0);
    for (std::size_t j = i; j < i + 3; ++j) {
      for (const double x : corners[j]) word(std::bit_cast<std::uint32_t>(static_cast<float>(x)));
    }
    bytes += std::string(2, '\0');
  }
  return bytes;
}

const std::vector<Vec3> kCorner = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};

std::vector<Vec3> points_of_file(const std::string& path) {
  return distinct_points(read_mesh_file(path).vertices);
}
std::vector<Vec3> points_of_obj(std::string_view text, const std::string& name) {
  return distinct_points(read_obj(text, name).vertices);
}
std::vector<Vec3> points_of_stl(std::string_view bytes, const std::string& name) {
  return distinct_points(read_stl(bytes, name).vertices);
}

template <class Read>
std::string mesh_error(Read&& read) {
  try {
    read();
  } catch (const MeshError& error) {
    return error.what();
  }
  return "";
}

TEST(Mesh, ObjReadsVerticesOnceInOrder) {
  EXPECT_EQ(points_of_file(TUMBLE_SCENES_DIR "/meshes/tetrahedron.obj"), kCorner);
  EXPECT_EQ(points_of_obj("v 0 0 0\r\nvn 1 1 1\n v\t1 0 0 1.0\nv 0 1 0\nv -0 1 0\nv 0 0 1\nf 1//1 2//1 3//1",
                          "m.obj"),
            kCorner);
}

TEST(Mesh, StlOfBothKindsGivesEachPointOnce) {
  EXPECT_EQ(points_of_file(TUMBLE_SCENES_DIR "/meshes/tetrahedron.stl"),
            (std::vector<Vec3>{kCorner[0], kCorner[2], kCorner[1], kCorner[3]}));
  const std::vector<Vec3> corners = {kCorner[0], kCorner[1], kCorner[2], kCorner[0], kCorner[1], kCorner[3]};
  EXPECT_EQ(points_of_stl(binary_stl(corners, 2), "m.stl"), kCorner);
}

TEST(Mesh, ErrorsNameFileLineAndValue) {
  EXPECT_EQ(mesh_error([] { points_of_obj("v 0 0 0\nv 1 x 0\n", "m.obj"); }),
            "m.obj:2: a vertex needs three numbers ( 1 x 0)");
  EXPECT_EQ(mesh_error([] { points_of_obj("v 1 2", "m.obj"); }),
            "m.obj:1: a vertex needs three numbers ( 1 2)");
  EXPECT_EQ(mesh_error([] { points_of_obj("v 1 2 nan", "m.obj"); }),
            "m.obj:1: a vertex must be finite (nan)");
  EXPECT_EQ(mesh_error([] { points_of_stl("solid a\n\nvertex 1 2 1e400\n", "m.stl"); }),
            "m.stl:3: a vertex needs three numbers ( 1 2 1e400)");
  EXPECT_EQ(mesh_error([] {
              points_of_stl(binary_stl({kCorner[0], kCorner[1], kCorner[2]}, 2), "m.stl");
            }),
            "m.stl: neither ASCII nor binary STL (134 bytes, header says 2 triangles)");
  EXPECT_EQ(mesh_error([] { points_of_stl("\x7f" + std::string(99, 'x'), "m.stl"); }),
            "m.stl: neither ASCII nor binary STL (100 bytes, header says 2021161080 triangles)");
  const std::vector<Vec3> infinite = {kCorner[0], kCorner[1],
                                      Vec3(0, 0, std::numeric_limits<double>::infinity())};
  EXPECT_EQ(mesh_error([&] { points_of_stl(binary_stl(infinite, 1), "m.stl"); }),
            "m.stl: a vertex must be finite (triangle 0)");
  EXPECT_EQ(mesh_error([] { points_of_file("none.stl"); }), "none.stl: cannot be read");
}

TEST(Mesh, PathsAreRelativeToTheScene) {
  EXPECT_EQ(resolve_mesh_path("a/b.obj", "scenes"), "scenes/a/b.obj");
  EXPECT_EQ(resolve_mesh_path("file://b.obj", "scenes"), "scenes/b.obj");
  EXPECT_EQ(resolve_mesh_path("file:///b.obj", "scenes"), "/b.obj");
  EXPECT_EQ(resolve_mesh_path("../b.obj", "scenes"), "b.obj");
  EXPECT_THROW(resolve_mesh_path("package://b.obj", ""), MeshError);
  EXPECT_THROW(resolve_mesh_path("", ""), MeshError);
}

}  // namespace
}  // namespace tumble
