// A dynamic tree of bounding boxes: insertion by the surface-area cost, rotations keep it shallow, removal is exact.
// Leaves carry an integer of the caller's. The shape of the tree depends on its history, the set of answers does not:
// callers sort what they get.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "collision/aabb.h"

namespace tumble {

class AabbTree {
 public:
  using Leaf = std::int32_t;
  static constexpr Leaf kNone = -1;

  Leaf insert(const Aabb& bounds, std::uint32_t user);
  void remove(Leaf leaf);
  /// Gives the leaf new bounds: removed and inserted again.
  void move(Leaf leaf, const Aabb& bounds);
  const Aabb& bounds(Leaf leaf) const { return at(leaf).bounds; }

  /// Appends the `user` of every leaf that overlaps `bounds`, in no useful order.
  void query(const Aabb& bounds, std::vector<std::uint32_t>& users) const;

  /// Offers the `user` of the leaves that a box moving from `start` with `velocity` touches before `limit`, the earlier
  /// child first: `limit = visit(user)` may come down with what is found. A leaf exactly at the limit is offered.
  /// A box of no size and a unit velocity make a ray, and times lengths [m].
  template <typename Visit>
  void cast(const Aabb& start, const Vec3& velocity, double limit, Visit&& visit) const {
    if (root_ != kNone) cast_below(root_, start, velocity, limit, visit);
  }

  /// Longest way from the root to a leaf; 0 for one leaf, -1 for none.
  int height() const;
  std::size_t size() const { return leaves_; }

 private:
  template <typename>
  friend struct Archived;  // its list of members, world/archive.cpp
  struct Node {
    Aabb bounds;
    Leaf parent = kNone;  // next free node when unused
    Leaf child[2] = {kNone, kNone};
    std::int32_t height = 0;  // 0: leaf
    std::uint32_t user = 0;
    bool is_leaf() const { return child[0] == kNone; }
  };

  template <typename Visit>
  void cast_below(Leaf node, const Aabb& start, const Vec3& velocity, double& limit, Visit& visit) const {
    if (at(node).is_leaf()) {
      limit = visit(at(node).user);
      return;
    }
    Leaf first = at(node).child[0], second = at(node).child[1];
    double enter_first = at(first).bounds.meets_at(start, velocity);
    double enter_second = at(second).bounds.meets_at(start, velocity);
    if (enter_second < enter_first) {
      std::swap(first, second);
      std::swap(enter_first, enter_second);
    }
    // An endless limit must not let in what is never met.
    const auto met = [&](double enter) { return enter <= limit && enter < kInfinity; };
    if (met(enter_first)) cast_below(first, start, velocity, limit, visit);
    if (met(enter_second)) cast_below(second, start, velocity, limit, visit);
  }

  Leaf allocate();
  void release(Leaf node);
  void insert_leaf(Leaf leaf);
  void remove_leaf(Leaf leaf);
  Leaf best_sibling(const Aabb& bounds) const;
  void refit(Leaf node);
  void refit_upwards(Leaf node);
  void rotate(Leaf node);
  void replace_child(Leaf parent, Leaf old_child, Leaf new_child);
  Node& at(Leaf node) { return nodes_[static_cast<std::size_t>(node)]; }
  const Node& at(Leaf node) const { return nodes_[static_cast<std::size_t>(node)]; }

  std::vector<Node> nodes_;
  Leaf root_ = kNone;
  Leaf free_ = kNone;
  std::size_t leaves_ = 0;
};

}  // namespace tumble
