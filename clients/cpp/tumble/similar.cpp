// Names that a user may have meant, by edit distance.
#include <algorithm>
#include <numeric>

#include "tumble/world.h"

namespace tumble::client {
namespace {

/// Levenshtein's distance: letters to insert, delete or replace.
std::size_t compute_edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::vector<std::string> similar_names(const std::string& name, const std::vector<std::string>& known) {
  std::vector<std::pair<std::size_t, std::string>> ranked;
  for (const std::string& candidate : known) {
    const bool part = !name.empty() && candidate.find(name) != std::string::npos;
    const std::size_t distance = part ? 1 : compute_edit_distance(name, candidate);
    if (distance <= 1 + name.size() / 3) ranked.emplace_back(distance, candidate);
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> best;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, ranked.size()); ++i) best.push_back(ranked[i].second);
  return best;
}

}  // namespace tumble::client
