// See sdf.h. The walk through a file: <sdf> -> <world> -> physics, models and populations, state, connections.
#include "scene/sdf.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <unordered_map>
#include <unordered_set>

#include "scene/sdf_connection.h"
#include "scene/sdf_model.h"
#include "scene/sdf_physics.h"
#include "scene/sdf_population.h"
#include "scene/sdf_state.h"

namespace tumble {
namespace {

constexpr int kOldestMinor = 4, kNewestMinor = 11;  // of SDF version 1.x
const Vec3 kSdfGravity(0.0, 0.0, -9.8);             // [m/s^2] SDF's default

void check_version(SdfElement& sdf) {
  const std::string version = sdf.required_attribute("version");
  for (int minor = kOldestMinor; minor <= kNewestMinor; ++minor) {
    if (version == "1." + std::to_string(minor)) return;
  }
  sdf.fail_attribute("version", "must be 1.4 to 1.11", version);
}

/// The bodies of a world by model, with every name taken once.
class Models {
 public:
  explicit Models(Scene& scene) : scene_(scene) {}

  void add(const SdfElement& element, PlacedModel model) {
    for (BodyDefinition& body : model.bodies) {
      check_body_name(element, body.name);
      if (!body.X_WL.p.allFinite()) element.fail("its position overflows", body.name);
      if (!names_.insert(body.name).second) element.fail_attribute("name", "is used twice", body.name);
      scene_.bodies.push_back(std::move(body));
    }
    for (SceneJoint& joint : model.joints) {
      check_body_name(element, joint.name);
      scene_.joints.push_back(std::move(joint));
    }
  }
  void add_model(SdfElement& element) {
    const SdfModel model = read_model(element, lookup());
    if (!frames_.emplace(model.name, model.X_WM.value_or(Pose{})).second) {
      element.fail_attribute("name", "is used twice", model.name);
    }
    add(element, placed(model, model.X_WM, model.name));
  }
  FrameLookup lookup() const {
    return [this](const std::string& name) -> std::optional<Pose> {
      const auto found = frames_.find(name);
      return found == frames_.end() ? std::nullopt : std::optional(found->second);
    };
  }

 private:
  Scene& scene_;
  std::unordered_set<std::string> names_;
  std::unordered_map<std::string, Pose> frames_;
};

std::uint64_t read_seed(SdfElement& world) {
  std::optional<SdfElement> seed = world.child("tumble:seed");
  return seed ? static_cast<std::uint64_t>(seed->to_integer(0, 2147483647)) : 1;
}

void read_world_options(SdfElement& world, Options& options) {
  options.gravity = kSdfGravity;
  std::optional<SdfElement> gravity = world.child("gravity");
  if (std::optional<SdfElement> physics = world.child("physics")) {
    if (std::optional<SdfElement> inner = physics->child("gravity")) {  // where SDF 1.4 had it
      if (gravity) inner->fail("may stand only once", "the world has one too");
      gravity = inner;
    }
    read_physics(*physics, options);
  }
  if (gravity) options.gravity = gravity->to_vector();
}

void read_world(SdfElement& world, Scene& scene) {
  scene.name = world.required_attribute("name");
  if (scene.name.empty()) world.fail_attribute("name", "must not be empty", scene.name);
  read_world_options(world, scene.options);
  const std::uint64_t seed = read_seed(world);
  world.refuse("include", "only meshes can be included, by <mesh><uri>");
  world.refuse("joint", "stands within a <model>; bodies of two models are joined by <tumble:joint>");
  Models models(scene);
  for (SdfElement& element : world.children({"model", "population"})) {
    if (element.tag() == "model") {
      models.add_model(element);
    } else {
      for (PlacedModel& model : read_population(element, models.lookup(), seed)) {
        models.add(element, std::move(model));
      }
    }
  }
  if (std::optional<SdfElement> state = world.child("state")) read_state(*state, scene);
  read_connections(world, scene);
  world.finish();
}

void parse(const std::string& text, const std::string& name, tinyxml2::XMLDocument& document) {
  if (const std::size_t zero = text.find('\0'); zero != std::string::npos) {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(zero), '\n');
    throw SceneError(name + ":" + std::to_string(line) + ": <sdf>: the file has a zero byte (not a text)");
  }
  if (document.Parse(text.data(), text.size()) == tinyxml2::XML_SUCCESS) return;
  throw SceneError(name + ":" + std::to_string(std::max(document.ErrorLineNum(), 1)) +
                   ": <sdf>: not well-formed XML (" +
                   tinyxml2::XMLDocument::ErrorIDToName(document.ErrorID()) + ")");
}

}  // namespace

SceneReading read_sdf_text(const std::string& text, const std::string& name, const std::string& directory) {
  tinyxml2::XMLDocument document;
  parse(text, name, document);
  SdfFile file{name, directory, {}};
  tinyxml2::XMLElement* root = document.RootElement();
  if (!root) throw SceneError(name + ":1: <sdf>: the file has no tags (an <sdf> is needed)");
  SdfElement sdf(*root, file);
  if (sdf.tag() != "sdf") sdf.fail("the outermost tag must be <sdf>", sdf.tag());
  if (tinyxml2::XMLElement* second = root->NextSiblingElement()) {
    SdfElement(*second, file).fail("stands behind the end of <sdf>");
  }
  check_version(sdf);
  SceneReading reading;
  SdfElement world = sdf.required_child("world");
  read_world(world, reading.scene);
  sdf.finish();
  reading.warnings = std::move(file.warnings);
  return reading;
}

SceneReading read_sdf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (std::filesystem::is_directory(path)) throw SceneError(path + ": is a folder, not a scene");
  if (!file) throw SceneError(path + ": the scene can't be read: " + std::strerror(errno));
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  return read_sdf_text(text, path, std::filesystem::path(path).parent_path().string());
}

}  // namespace tumble
