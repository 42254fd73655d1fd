// Inputs that were kept in files: findings, and what covers much.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <vector>

namespace tumble::test {

std::vector<std::uint8_t> read_input(const std::filesystem::path& path);
/// In hex, on one line.
void print_input(const std::vector<std::uint8_t>& input);
/// The file itself, or all in the folder.
std::set<std::filesystem::path> files_below(const std::filesystem::path& path);

}  // namespace tumble::test
