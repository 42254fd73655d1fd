// Surfaces from the scene file: meshes of static links, height maps from images, and our own tags.
#include <gtest/gtest.h>

#include "scene/image.h"
#include "scene/mesh.h"
#include "scene_bits.h"
#include "scene_text.h"

namespace tumble {
namespace {

std::string in_static(const std::string& geometry) {
  return in_world("<model name='m'><static>true</static>\n<link name='l'>\n<collision name='c'><geometry>\n" +
                  geometry + "\n</geometry></collision></link></model>");
}

GeometryDefinition read_static(const std::string& geometry) {
  const SceneReading reading = read(in_static(geometry));
  EXPECT_TRUE(reading.warnings.empty()) << reading.warnings.front();
  return reading.scene.bodies.at(0).geometries.at(0);
}

const std::string kMesh = "<mesh><uri>meshes/tetrahedron.obj</uri><scale>2 1 0.5</scale></mesh>";

TEST(SdfSurface, AMeshIsASurfaceOnAStaticLinkAndAHullOnOneThatMoves) {
  for (const char* file : {"meshes/tetrahedron.obj", "meshes/tetrahedron.stl"}) {
    const Shape shape =
        read_static("<mesh><uri>" + std::string(file) + "</uri><scale>2 1 0.5</scale></mesh>").shape;
    const TriangleMesh& mesh = *std::get<TriangleMeshPointer>(shape);
    EXPECT_EQ(mesh.triangle_count(), 4u);
    EXPECT_EQ(mesh.vertices().size(), 4u);
    EXPECT_EQ(mesh.open_edges(), 0u);
    EXPECT_EQ(mesh.odd_edges(), 0u);
    EXPECT_EQ(mesh.bounds().upper, Vec3(2, 1, 0.5));
  }
  const Shape hull =
      read_static("<mesh optimization='convex_hull'><uri>meshes/tetrahedron.obj</uri></mesh>").shape;
  EXPECT_TRUE(std::holds_alternative<HullPointer>(hull));
  const Shape moving = read(in_geometry(kMesh)).scene.bodies.at(0).geometries.at(0).shape;
  EXPECT_TRUE(std::holds_alternative<HullPointer>(moving));
}

TEST(SdfSurface, AHeightmapIsAnImageStretchedOverItsSize) {
  const GeometryDefinition field = read_static(
      "<heightmap><uri>heightmaps/steps_8bit.png</uri><size>4 2 10</size><pos>1 2 3</pos></heightmap>");
  EXPECT_EQ(field.X_LS.p, Vec3(1, 2, 3));
  const HeightField& grid = *std::get<HeightFieldPointer>(field.shape);
  EXPECT_EQ(grid.columns(), 3u);
  EXPECT_EQ(grid.rows(), 2u);
  EXPECT_EQ(grid.dx(), 2.0);
  EXPECT_EQ(grid.dy(), 2.0);
  // The image's lower row lies at least y. 0, 51, .. 255 of 255 are fifths.
  const std::vector<double> expected = {6.0, 8.0, 10.0, 0.0, 2.0, 4.0};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(grid.heights()[i], expected[i], 1e-15);
  const Shape rgb =
      read_static("<heightmap><uri>heightmaps/steps_rgb.png</uri><size>4 2 10</size></heightmap>").shape;
  EXPECT_EQ(std::get<HeightFieldPointer>(rgb)->heights(), grid.heights());
}

TEST(SdfSurface, SixteenBitImagesKeepTheirSteps) {
  const GrayImage image = read_gray_image(TUMBLE_SCENES_DIR "/heightmaps/steps_16bit.png");
  ASSERT_EQ(image.brightness.size(), 6u);
  const double values[] = {0, 1, 256, 257, 32768, 65535};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(image.brightness[i], values[i] / 65535.0);
}

TEST(SdfSurface, EverySurfaceIsWrittenAndReadBackToTheBit) {
  const std::string heights =
      "<tumble:height_field><tumble:columns>2</tumble:columns><tumble:rows>3</tumble:rows>"
      "<tumble:spacing>0.1 0.3</tumble:spacing><tumble:heights>0 0.1 0.2 -1e-3 5 6</tumble:heights>"
      "</tumble:height_field>";
  const std::string triangles =
      "<tumble:triangle_mesh><tumble:vertices>0 0 0 1 0 0.1 0 1 0.3</tumble:vertices>"
      "<tumble:triangles>0 1 2</tumble:triangles></tumble:triangle_mesh>";
  const std::string image =
      "<heightmap><uri>heightmaps/steps_8bit.png</uri><size>0.7 0.3 0.1</size></heightmap>";
  for (const std::string& geometry : {kMesh, heights, triangles, image}) {
    const Scene scene = read(in_static(geometry)).scene;
    const std::string text = write_sdf(scene);
    const SceneReading again = read_sdf_text(text, "written.sdf", "");
    EXPECT_TRUE(again.warnings.empty()) << again.warnings.front();
    EXPECT_TRUE(SceneBits(again.scene) == SceneBits(scene)) << geometry;
    EXPECT_EQ(write_sdf(again.scene), text);
  }
}

TEST(SdfSurface, ErrorsNameFileLineAndValue) {
  const auto expect = [](const std::string& text, const std::string& error) {
    EXPECT_EQ(error_of(text), error);
  };
  expect(in_geometry("<tumble:triangle_mesh><tumble:vertices>0 0 0 1 0 0 0 1 0</tumble:vertices>"
                     "<tumble:triangles>0 1 2</tumble:triangles></tumble:triangle_mesh>"),
         "s.sdf:6: <tumble:triangle_mesh>: needs a static model: it has no mass");
  expect(in_geometry("<heightmap><uri>heightmaps/steps_8bit.png</uri></heightmap>"),
         "s.sdf:6: <heightmap>: needs a static model: it has no mass");
  expect(in_static("<tumble:triangle_mesh><tumble:vertices>0 0 0 1 0 0 0 1 0</tumble:vertices>\n"
                   "<tumble:triangles>0 1 2.5</tumble:triangles></tumble:triangle_mesh>"),
         "s.sdf:7: <tumble:triangles>: must be whole numbers >= 0 (2.5)");
  expect(in_static("<tumble:triangle_mesh><tumble:vertices>0 0 0 1 0 0 0 1 0</tumble:vertices>"
                   "<tumble:triangles>0 1 3</tumble:triangles></tumble:triangle_mesh>"),
         "s.sdf:6: <tumble:triangle_mesh>: triangle mesh: triangle 0 names vertex 3 of 3");
  expect(in_static("<heightmap><uri>none.png</uri></heightmap>"),
         "s.sdf:6: <uri>: " TUMBLE_SCENES_DIR "/none.png: cannot be read");
  const std::string no_image = error_of(in_static("<heightmap><uri>ball.sdf</uri></heightmap>"));
  EXPECT_EQ(no_image.find("s.sdf:6: <uri>: " TUMBLE_SCENES_DIR "/ball.sdf: no readable PNG ("), 0u)
      << no_image;
  expect(in_static("<heightmap><uri>heightmaps/steps_8bit.png</uri>\n<size>1 0 1</size></heightmap>"),
         "s.sdf:7: <size>: must be > 0 (1 0 1)");
  expect(
      in_static(
          "<tumble:height_field><tumble:columns>2</tumble:columns><tumble:rows>2</tumble:rows>"
          "<tumble:spacing>1 1</tumble:spacing><tumble:heights>1 2 3</tumble:heights></tumble:height_field>"),
      "s.sdf:6: <tumble:height_field>: height field: 2 x 2 needs 4 heights (3)");
}

TEST(SdfSurface, TrianglesWithoutAreaAreAWarning) {
  const SceneReading reading =
      read(in_static("<tumble:triangle_mesh><tumble:vertices>0 0 0 1 0 0 0 1 0</tumble:vertices>"
                     "<tumble:triangles>0 1 2 0 1 1</tumble:triangles></tumble:triangle_mesh>"));
  ASSERT_EQ(reading.warnings.size(), 1u);
  EXPECT_EQ(reading.warnings[0],
            "s.sdf:6: <tumble:triangle_mesh>: 1 of 2 triangles have no area and are left out");
}

TEST(Mesh, ObjFacesAreFansWithIndicesFromEitherEnd) {
  const MeshTriangles mesh =
      read_obj("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1/1 2/1 3/1 4/1\nf -4//2 -3//2 -2//2", "m.obj");
  const std::vector<std::array<std::uint32_t, 3>> expected = {{0, 1, 2}, {0, 2, 3}, {0, 1, 2}};
  EXPECT_EQ(mesh.triangles, expected);
  const auto error = [](const char* text) {
    try {
      read_obj(text, "m.obj");
    } catch (const MeshError& problem) {
      return std::string(problem.what());
    }
    return std::string();
  };
  EXPECT_EQ(error("v 0 0 0\nf 1 1"), "m.obj:2: a face needs three corners or more ( 1 1)");
  EXPECT_EQ(error("v 0 0 0\nf 1 1 2"), "m.obj:2: a face names a vertex that is not above it, of 1 (2)");
  EXPECT_EQ(error("v 0 0 0\nf 1 x 1"), "m.obj:2: a face's corner needs the number of a vertex (x)");
}

}  // namespace
}  // namespace tumble
