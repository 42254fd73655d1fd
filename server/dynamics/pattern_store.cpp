// See pattern_store.h.
#include "dynamics/pattern_store.h"

#include <algorithm>

#include "math/hash.h"

namespace tumble {

std::shared_ptr<const BlockPattern> PatternStore::find(std::uint32_t size,
                                                       const std::vector<BlockPattern::Edge>& edges,
                                                       std::uint64_t limit) {
  Hash hash;
  for (const auto& [a, b] : edges) hash.add(std::uint64_t{a} << 32 | b);
  const std::uint64_t key = hash.value();
  auto at = std::lower_bound(kept_.begin(), kept_.end(), key,
                             [](const Kept& kept, std::uint64_t k) { return kept.key < k; });
  for (; at != kept_.end() && at->key == key; ++at) {
    if (at->size != size || at->limit != limit || at->edges != edges) continue;
    at->used = true;
    ++found_;
    return at->pattern;
  }
  ++made_;
  auto pattern = std::make_shared<const BlockPattern>(size, edges, limit);
  kept_.insert(at, {key, size, limit, edges, pattern, true});
  return pattern;
}

void PatternStore::end_step() {
  std::erase_if(kept_, [](const Kept& kept) { return !kept.used; });
  for (Kept& kept : kept_) kept.used = false;
}

}  // namespace tumble
