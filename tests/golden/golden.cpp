// golden HASHES SCENES: steps the scenes that the file HASHES lists ("SCENE STEPS HASH" a line, # comments) and writes
// the file again with the hashes found. Exit status: 0 all as listed, 1 some differ, 2 two runs in one process differ
// or an input is wrong. Same input, same bits: the listed hashes hold for every compiler and optimisation level.
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "scene/sdf.h"

namespace {

struct Entry {
  std::string scene;
  int steps = 0;
  std::string hash;
};

Entry parse_entry(const std::string& line) {
  Entry entry;
  std::istringstream words(line);
  if (!(words >> entry.scene >> entry.steps) || entry.steps < 1) {
    throw std::invalid_argument("not \"SCENE STEPS HASH\": " + line);
  }
  words >> entry.hash;
  return entry;
}

/// The hash after the entry's steps, of two worlds stepped in turn: what one leaves behind must not reach the other.
std::string compute_hash(const Entry& entry, const std::string& directory) {
  const tumble::Scene scene = tumble::read_sdf(directory + "/" + entry.scene).scene;
  tumble::World first = tumble::build_world(scene);
  tumble::World second = tumble::build_world(scene);
  for (int i = 0; i < entry.steps; ++i) {
    first.step();
    second.step();
    if (first.state_hash() != second.state_hash()) {
      throw std::logic_error(entry.scene + ": two runs in one process differ at step " +
                             std::to_string(i + 1));
    }
  }
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(first.state_hash()));
  return text;
}

bool check_file(const std::string& file, const std::string& directory) {
  std::ifstream input(file);
  if (!input) throw std::invalid_argument(file + ": cannot be read");
  bool same = true;
  for (std::string line; std::getline(input, line);) {
    if (line.empty() || line[0] == '#') {
      std::printf("%s\n", line.c_str());
      continue;
    }
    const Entry entry = parse_entry(line);
    const std::string hash = compute_hash(entry, directory);
    std::printf("%s %d %s\n", entry.scene.c_str(), entry.steps, hash.c_str());
    if (hash == entry.hash) continue;
    same = false;
    std::fprintf(stderr, "%s after %d steps: %s, listed is %s\n", entry.scene.c_str(), entry.steps,
                 hash.c_str(), entry.hash.c_str());
  }
  return same;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: golden HASHES SCENES\n");
    return 2;
  }
  try {
    return check_file(argv[1], argv[2]) ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "golden: %s\n", error.what());
    return 2;
  }
}
