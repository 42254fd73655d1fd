// See clear_pairs.h.
#include "world/clear_pairs.h"

#include <algorithm>
#include <tuple>

namespace tumble {
namespace {

bool comes_first(const ClearPair& l, const ClearPair& r) {
  return std::tie(l.a, l.b) < std::tie(r.a, r.b);
}

}  // namespace

bool ClearPairs::holds(GeometryPair pair) const {
  return std::binary_search(pairs_.begin(), pairs_.end(), ClearPair{.a = pair.a, .b = pair.b}, comes_first);
}

void ClearPairs::settle() {
  if (incoming_.empty()) return;
  std::stable_sort(incoming_.begin(), incoming_.end(), comes_first);
  std::erase_if(incoming_, [this](const ClearPair& p) { return holds({p.a, p.b}); });
  const auto same = [](const ClearPair& l, const ClearPair& r) { return l.a == r.a && l.b == r.b; };
  incoming_.erase(std::unique(incoming_.begin(), incoming_.end(), same), incoming_.end());
  const auto old = static_cast<std::ptrdiff_t>(pairs_.size());
  pairs_.insert(pairs_.end(), incoming_.begin(), incoming_.end());
  std::inplace_merge(pairs_.begin(), pairs_.begin() + old, pairs_.end(), comes_first);
  incoming_.clear();
}

void ClearPairs::take_due(std::uint64_t step, const std::vector<std::uint32_t>& ways,
                          std::vector<GeometryPair>& due) {
  std::erase_if(pairs_, [&](const ClearPair& p) {
    if (step < p.until && ways[p.body_a] == p.way_a && ways[p.body_b] == p.way_b) return false;
    due.push_back({p.a, p.b});
    return true;
  });
}

void ClearPairs::forget(std::uint32_t slot) {
  std::erase_if(pairs_, [slot](const ClearPair& p) { return p.body_a == slot || p.body_b == slot; });
}

}  // namespace tumble
