// See broad_phase.h.
#include "collision/broad_phase.h"

#include <algorithm>
#include <cassert>

namespace tumble {
namespace {

/// A new fat box reaches ahead by this many steps of the present motion. Longer boxes are renewed more rarely, but meet
/// more that they never touch. Measured on 1000 unit boxes in a cage of 16 m, up to 5 m/s and 1/240 s: 1, 2, 4, 8 steps
/// renew 470, 302, 184, 106 boxes a step (2.3, 1.6, 1.1, 0.6 ms) and keep 1930, 2010, 2180, 2530 pairs; at 100 m/s the
/// pairs grow to 1840, 2780, 5450, 14300. Four halves the cost of two without flooding the narrow phase.
constexpr double kStepsAhead = 4.0;

}  // namespace

void BroadPhase::add(std::uint32_t index, const Aabb& tight, double fat_margin, bool moves) {
  if (index >= proxies_.size()) proxies_.resize(index + 1);
  Proxy& proxy = proxies_[index];
  assert(proxy.leaf == AabbTree::kNone);
  proxy.moves = moves;
  proxy.leaf = tree_of(proxy).insert(tight.grown(fat_margin), index);
  mark_dirty(index);
}

void BroadPhase::remove(std::uint32_t index) {
  Proxy& proxy = proxies_[index];
  tree_of(proxy).remove(proxy.leaf);
  proxy.leaf =
      AabbTree::kNone;  // `dirty` stays: it says that the index is in the list, which update_pairs cleans
}

bool BroadPhase::move(std::uint32_t index, const Aabb& tight, double fat_margin, const Vec3& displacement) {
  const Proxy& proxy = proxies_[index];
  if (fat_bounds(index).contains(tight.swept(displacement))) return false;
  tree_of(proxy).move(proxy.leaf, tight.swept(kStepsAhead * displacement).grown(fat_margin));
  mark_dirty(index);
  ++boxes_renewed_;
  return true;
}

void BroadPhase::place(std::uint32_t index, const Aabb& bounds) {
  const Proxy& proxy = proxies_[index];
  tree_of(proxy).move(proxy.leaf, bounds);
  ++boxes_renewed_;
}

void BroadPhase::update_pairs(std::vector<GeometryPair>& pairs) {
  const auto first = static_cast<std::ptrdiff_t>(pairs.size());
  for (const std::uint32_t index : dirty_) {
    Proxy& proxy = proxies_[index];
    proxy.dirty = false;
    if (proxy.leaf == AabbTree::kNone) continue;
    const Aabb& fat = fat_bounds(index);
    found_.clear();
    moving_.query(fat, found_);
    if (proxy.moves) fixed_.query(fat, found_);
    for (const std::uint32_t other : found_) {
      if (other != index) pairs.push_back({std::min(index, other), std::max(index, other)});
    }
  }
  dirty_.clear();
  std::sort(pairs.begin() + first, pairs.end());
  pairs.erase(std::unique(pairs.begin() + first, pairs.end()), pairs.end());
}

bool BroadPhase::overlaps(GeometryPair pair) const {
  return fat_bounds(pair.a).overlaps(fat_bounds(pair.b));
}

const Aabb& BroadPhase::fat_bounds(std::uint32_t index) const {
  const Proxy& proxy = proxies_[index];
  assert(proxy.leaf != AabbTree::kNone);
  return tree_of(proxy).bounds(proxy.leaf);
}

void BroadPhase::query(const Aabb& bounds, std::vector<std::uint32_t>& indices) const {
  const auto first = static_cast<std::ptrdiff_t>(indices.size());
  moving_.query(bounds, indices);
  fixed_.query(bounds, indices);
  std::sort(indices.begin() + first, indices.end());
}

void BroadPhase::mark_dirty(std::uint32_t index) {
  if (proxies_[index].dirty) return;
  proxies_[index].dirty = true;
  dirty_.push_back(index);
}

}  // namespace tumble
