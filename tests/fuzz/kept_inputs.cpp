// See kept_inputs.h.
#include "kept_inputs.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

namespace tumble::test {

std::vector<std::uint8_t> read_input(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void print_input(const std::vector<std::uint8_t>& input) {
  fmt::print(" ");
  for (const std::uint8_t byte : input) fmt::print("{:02x}", byte);
  fmt::print("\n");
}

std::set<std::filesystem::path> files_below(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return {path};
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(path)) files.insert(entry.path());
  return files;
}

}  // namespace tumble::test
