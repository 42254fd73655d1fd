// See sdf_population.h. Frame P: the population's pose; every arrangement is centred on its origin.
#include "scene/sdf_population.h"

#include <array>

#include "math/hash.h"
#include "scene/random.h"
#include "scene/sdf_pose.h"

namespace tumble {
namespace {

constexpr int kMostModels = 1000000;

/// Where models may stand: a box, or an upright cylinder inside it.
struct Region {
  Vec3 size = Vec3::Zero();  // [m]
  bool round = false;

  bool contains(const Vec3& p) const {
    return !round || p.head<2>().squaredNorm() <= 0.25 * size.x() * size.x();
  }
};

std::optional<Region> read_region(SdfElement& population) {
  std::optional<SdfElement> box = population.child("box"), cylinder = population.child("cylinder");
  if (box && cylinder) cylinder->fail("a population has one region only");
  Region region;
  if (box) {
    SdfElement size = box->required_child("size");
    region.size = size.to_vector();
    if (!(region.size.minCoeff() >= 0.0)) size.fail("must be >= 0", size.to_text());
    box->finish();
  } else if (cylinder) {
    const double radius = cylinder->required_child("radius").to_number(Range::positive);
    const double length = cylinder->required_child("length").to_number(Range::non_negative);
    region = {Vec3(2.0 * radius, 2.0 * radius, length), true};
    cylinder->finish();
  } else {
    return std::nullopt;
  }
  return region;
}

int read_count(SdfElement& distribution, const char* tag) {
  std::optional<SdfElement> count = distribution.child(tag);
  return count ? count->to_integer(1, kMostModels) : 1;
}

/// Rows along y, columns along x, layers along z; columns run first.
std::vector<Vec3> arrange_grid(SdfElement& distribution, int count) {
  const int rows = read_count(distribution, "rows"), columns = read_count(distribution, "cols");
  const int layers = read_count(distribution, "tumble:layers");
  const Vec3 step = distribution.required_child("step").to_vector();
  const double places = static_cast<double>(rows) * columns * layers;
  if (places < count) distribution.fail("the grid has fewer places than models", to_shortest_text(places));
  std::vector<Vec3> offsets;
  for (int i = 0; i < count; ++i) {
    const int column = i % columns, row = i / columns % rows, layer = i / columns / rows;
    offsets.push_back(Vec3((column - 0.5 * (columns - 1)) * step.x(), (row - 0.5 * (rows - 1)) * step.y(),
                           (layer - 0.5 * (layers - 1)) * step.z()));
  }
  return offsets;
}

/// The middles of `count` equal pieces of the region's length along one axis.
std::vector<Vec3> arrange_line(const Region& region, int axis, int count) {
  std::vector<Vec3> offsets(static_cast<std::size_t>(count), Vec3::Zero());
  for (int i = 0; i < count; ++i) {
    offsets[static_cast<std::size_t>(i)][axis] = ((i + 0.5) / count - 0.5) * region.size[axis];
  }
  return offsets;
}

/// The middles of the cells inside the region, cells[axis] along each axis.
std::vector<Vec3> cell_middles(const Region& region, const std::array<int, 3>& cells) {
  std::vector<Vec3> middles;
  for (int i = 0; i < cells[0] * cells[1] * cells[2]; ++i) {
    const std::array<int, 3> index = {i % cells[0], i / cells[0] % cells[1], i / cells[0] / cells[1]};
    Vec3 p;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      p[axis] = ((index[k] + 0.5) / cells[k] - 0.5) * region.size[axis];
    }
    if (region.contains(p)) middles.push_back(p);
  }
  return middles;
}

/// The middles of equal cells that are as cubic as they get.
std::vector<Vec3> arrange_evenly(const Region& region, int count) {
  std::array<int, 3> cells = {1, 1, 1};
  const auto add_cells = [&] {
    std::size_t longest = 0;
    const auto length = [&](std::size_t k) { return region.size[static_cast<Eigen::Index>(k)] / cells[k]; };
    for (std::size_t k = 1; k < 3; ++k) longest = length(k) > length(longest) ? k : longest;
    ++cells[longest];
  };
  while (cells[0] * cells[1] * cells[2] < count) add_cells();
  std::vector<Vec3> middles = cell_middles(region, cells);
  while (middles.size() < static_cast<std::size_t>(count)) {  // a cylinder leaves corners empty
    add_cells();
    middles = cell_middles(region, cells);
  }
  middles.resize(static_cast<std::size_t>(count));
  return middles;
}

std::vector<Vec3> arrange_randomly(const Region& region, int count, Random& random) {
  std::vector<Vec3> offsets;
  while (offsets.size() < static_cast<std::size_t>(count)) {
    const Vec3 p = random.in_box(0.5 * region.size);
    if (region.contains(p)) offsets.push_back(p);
  }
  return offsets;
}

std::vector<Vec3> arrange(SdfElement& distribution, const std::optional<Region>& region, int count,
                          Random& random) {
  SdfElement type = distribution.required_child("type");
  const std::string name = type.to_text();
  if (name == "grid") return arrange_grid(distribution, count);
  const bool is_known =
      name == "random" || name == "uniform" || name == "linear-x" || name == "linear-y" || name == "linear-z";
  if (!is_known) type.fail("must be random, uniform, grid, linear-x, linear-y or linear-z", name);
  if (!region || !(region->size.maxCoeff() > 0.0)) {
    distribution.fail("needs a <box> or <cylinder> of the population to fill", name);
  }
  if (name == "random") return arrange_randomly(*region, count, random);
  if (name == "uniform") return arrange_evenly(*region, count);
  return arrange_line(*region, name.back() - 'x', count);
}

std::uint64_t mixed_seed(std::uint64_t seed, const std::string& name) {
  Hash hash;
  hash.add(seed);
  for (const char c : name) hash.add(static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
  return hash.value();
}

}  // namespace

std::vector<PlacedModel> read_population(SdfElement& population, const FrameLookup& find_frame,
                                         std::uint64_t seed) {
  const std::string name = population.required_attribute("name");
  SdfElement model_element = population.required_child("model");
  const SdfModel model = read_model(model_element, find_frame);
  std::optional<Pose> X_WP;
  if (std::optional<SdfElement> pose = population.child("pose")) X_WP = read_pose(*pose);
  const int count = population.required_child("model_count").to_integer(1, kMostModels);
  const std::optional<Region> region = read_region(population);

  Random random(mixed_seed(seed, name));
  SdfElement distribution = population.required_child("distribution");
  std::vector<Vec3> offsets = arrange(distribution, region, count, random);
  const Vec3 jitter = distribution.vector("tumble:jitter").value_or(Vec3::Zero());
  const bool turn = distribution.flag("tumble:random_rotation").value_or(false);
  distribution.finish();
  population.finish();

  std::vector<PlacedModel> models;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const Vec3 shift = random.in_box(jitter);
    const Quat rotation = turn ? random.rotation() : Quat::Identity();
    const Pose X_PM = chained(Pose{rotation, offsets[i] + shift}, model.X_WM);
    const std::string clone_name = model.name + "_" + std::to_string(i);
    check_body_name(model_element, clone_name);
    models.push_back(placed(model, chained(X_WP, X_PM), clone_name));
  }
  return models;
}

}  // namespace tumble
