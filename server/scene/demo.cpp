// See demo.h. The list is written by the build from tests/scenes (server/CMakeLists.txt).
#include "scene/demo.h"

namespace tumble {
namespace {

struct Demo {
  std::string_view name, text;
};

constexpr Demo kDemos[] = {
#include <demo_scenes.inc>
};

}  // namespace

std::vector<std::string_view> demo_names() {
  std::vector<std::string_view> names;
  for (const Demo& demo : kDemos) names.push_back(demo.name);
  return names;
}

std::string_view demo_text(std::string_view name) {
  for (const Demo& demo : kDemos) {
    if (demo.name == name) return demo.text;
  }
  return {};
}

}  // namespace tumble
