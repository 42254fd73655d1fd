// Whatever bytes arrive, the reader reads or throws SceneError: valid scenes with random damage, the same damage in
// every run. What it does read is finite.
#include <gtest/gtest.h>

#include <array>

#include "scene/demo.h"
#include "scene/random.h"
#include "scene_text.h"

namespace tumble {
namespace {

constexpr int kMutations = 4000;
constexpr std::size_t kLongest = 7000;  // bytes of a scene that is mutated

constexpr std::array<const char*, 24> kPieces = {"0",
                                                 "-1",
                                                 "nan",
                                                 "-inf",
                                                 "1e308",
                                                 "1e-320",
                                                 "999999999999",
                                                 "",
                                                 " ",
                                                 "<",
                                                 ">",
                                                 "/>",
                                                 "</model>",
                                                 "&#0;",
                                                 "&lt;",
                                                 "\"",
                                                 "'",
                                                 "<pose>1 2</pose>",
                                                 "<link name='link'>",
                                                 "<!--",
                                                 "]]>",
                                                 "<![CDATA[",
                                                 "name=''",
                                                 "\xff\xfe"};

std::size_t below(Random& random, std::size_t limit) {
  return static_cast<std::size_t>(random.word() % limit);
}

/// One to four times: a byte changed, a piece put in, a stretch taken out or doubled, or a number replaced.
std::string mutated(std::string text, Random& random) {
  const std::size_t times = 1 + below(random, 4);
  for (std::size_t i = 0; i < times && !text.empty(); ++i) {
    const std::size_t place = below(random, text.size());
    const std::size_t length = std::min(text.size() - place, 1 + below(random, 40));
    const std::size_t kind = below(random, 5);
    const char* piece = kPieces[below(random, kPieces.size())];
    if (kind == 0) text[place] = static_cast<char>(random.word());
    if (kind == 1) text.insert(place, piece);
    if (kind == 2) text.erase(place, length);
    if (kind == 3) text.insert(place, text.substr(place, length));
    if (kind == 4) {
      const std::size_t digit = text.find_first_of("0123456789", place);
      if (digit != std::string::npos) text.replace(digit, 1, piece);
    }
  }
  return text;
}

void expect_finite(const Scene& scene) {
  for (const BodyDefinition& body : scene.bodies) {
    EXPECT_TRUE(body.X_WL.p.allFinite() && body.X_WL.q.coeffs().allFinite());
    EXPECT_TRUE(body.v_WB.allFinite() && body.w_WB.allFinite());
    EXPECT_NEAR(body.X_WL.q.squaredNorm(), 1.0, 1e-13);
    if (body.inertia) {
      EXPECT_EQ(check_inertia(*body.inertia), "");
    }
    for (const GeometryDefinition& geometry : body.geometries) EXPECT_EQ(check_shape(geometry.shape), "");
  }
}

TEST(SdfMutation, DamagedScenesAreReadOrRefused) {
  std::vector<std::string> seeds;
  for (const std::string_view name : demo_names()) {
    if (demo_text(name).size() <= kLongest) seeds.emplace_back(demo_text(name));
  }
  ASSERT_GE(seeds.size(), 2u);
  seeds.push_back(
      write_sdf(read(beside_ball("<velocity_decay><linear>0.5</linear></velocity_decay>")).scene));
  Random random(20);
  int read_count = 0, refused = 0;
  for (int i = 0; i < kMutations; ++i) {
    const std::string text = mutated(seeds[below(random, seeds.size())], random);
    try {
      expect_finite(read_sdf_text(text, "m.sdf", "").scene);
      ++read_count;
    } catch (const SceneError& error) {
      ++refused;
      EXPECT_EQ(std::string(error.what()).find("m.sdf:"), 0u) << error.what();
    }
  }
  EXPECT_GT(read_count, kMutations / 20);  // 346 of 4000 measured
  EXPECT_GT(refused, kMutations / 20);
}

}  // namespace
}  // namespace tumble
