// Which pairs could touch. Every geometry has a proxy: a fat box in one of two trees (things that never move, things
// that may). Only proxies that left their fat box search for new pairs, so resting bodies cost nothing.
#pragma once

#include <compare>
#include <cstdint>
#include <vector>

#include "collision/aabb_tree.h"

namespace tumble {

/// A pair of geometries by the caller's indices, a < b. Of a surface of triangles one part is meant, else part is 0.
struct GeometryPair {
  std::uint32_t a = 0, b = 0;
  std::uint32_t part = 0;
  auto operator<=>(const GeometryPair&) const = default;
};

class BroadPhase {
 public:
  /// Adds geometry `index` (the caller's, dense from 0, free ones may be used again). Its fat box is `tight` grown by
  /// `fat_margin` [m]. Searches for pairs at the next `update_pairs`.
  void add(std::uint32_t index, const Aabb& tight, double fat_margin, bool moves);
  void remove(std::uint32_t index);

  /// The geometry is now within `tight` and will move by about `displacement` [m] this step. Returns true, and gives
  /// it a new fat box, if it leaves the old one in this step; so a fat box always covers the step ahead of it.
  bool move(std::uint32_t index, const Aabb& tight, double fat_margin, const Vec3& displacement);

  /// Gives the geometry this very box, in which the caller has found no other: it is not searched for pairs.
  void place(std::uint32_t index, const Aabb& bounds);

  /// Appends to `pairs`, sorted and without duplicates, every pair of overlapping fat boxes in which at least one
  /// proxy was added or got a new box since the last call. Two that do not move never pair.
  void update_pairs(std::vector<GeometryPair>& pairs);

  /// True while the fat boxes of the pair overlap.
  bool overlaps(GeometryPair pair) const;

  const Aabb& fat_bounds(std::uint32_t index) const;

  /// Appends every geometry whose fat box overlaps `bounds`, in ascending order.
  void query(const Aabb& bounds, std::vector<std::uint32_t>& indices) const;

  /// Offers every geometry whose fat box a box moving from `start` touches before `limit`: see AabbTree::cast.
  template <typename Visit>
  void cast(const Aabb& start, const Vec3& velocity, double limit, Visit&& visit) const {
    const auto lowered = [&](std::uint32_t index) { return limit = visit(index); };
    fixed_.cast(start, velocity, limit, lowered);
    moving_.cast(start, velocity, limit, lowered);
  }

  std::uint64_t boxes_renewed() const { return boxes_renewed_; }

 private:
  template <typename>
  friend struct Archived;  // its list of members, world/archive.cpp
  struct Proxy {
    AabbTree::Leaf leaf = AabbTree::kNone;
    bool moves = false;
    bool dirty = false;
  };
  const AabbTree& tree_of(const Proxy& proxy) const { return proxy.moves ? moving_ : fixed_; }
  AabbTree& tree_of(const Proxy& proxy) { return proxy.moves ? moving_ : fixed_; }
  void mark_dirty(std::uint32_t index);

  AabbTree moving_, fixed_;
  std::vector<Proxy> proxies_;
  std::vector<std::uint32_t> dirty_;
  std::vector<std::uint32_t> found_;
  std::uint64_t boxes_renewed_ = 0;
};

}  // namespace tumble
