// See aabb_tree.h. Greedy descent by the surface-area heuristic (Goldsmith & Salmon 1987) and tree rotations on the way
// back up (Kopta et al. 2012).
#include "collision/aabb_tree.h"

#include <algorithm>
#include <cassert>

namespace tumble {

AabbTree::Leaf AabbTree::insert(const Aabb& bounds, std::uint32_t user) {
  assert((bounds.lower.array() <= bounds.upper.array()).all());
  const Leaf leaf = allocate();
  Node& node = nodes_[static_cast<std::size_t>(leaf)];
  node.bounds = bounds;
  node.user = user;
  insert_leaf(leaf);
  ++leaves_;
  return leaf;
}

void AabbTree::remove(Leaf leaf) {
  assert(at(leaf).is_leaf());
  remove_leaf(leaf);
  release(leaf);
  --leaves_;
}

void AabbTree::move(Leaf leaf, const Aabb& bounds) {
  assert(at(leaf).is_leaf());
  assert((bounds.lower.array() <= bounds.upper.array()).all());
  remove_leaf(leaf);
  at(leaf).bounds = bounds;
  insert_leaf(leaf);
}

/// Walks without a stack, by the parents: no allocation and no limit on the height.
void AabbTree::query(const Aabb& bounds, std::vector<std::uint32_t>& users) const {
  Leaf node = root_;
  while (node != kNone) {
    const Node& n = at(node);
    if (n.bounds.overlaps(bounds)) {
      if (!n.is_leaf()) {
        node = n.child[0];
        continue;
      }
      users.push_back(n.user);
    }
    while (at(node).parent != kNone && node == at(at(node).parent).child[1]) node = at(node).parent;
    const Leaf parent = at(node).parent;
    node = parent == kNone ? kNone : at(parent).child[1];
  }
}

int AabbTree::height() const {
  return root_ == kNone ? -1 : at(root_).height;
}

AabbTree::Leaf AabbTree::allocate() {
  if (free_ == kNone) {
    nodes_.emplace_back();
    return static_cast<Leaf>(nodes_.size() - 1);
  }
  const Leaf node = free_;
  free_ = at(node).parent;
  at(node) = Node{};
  return node;
}

void AabbTree::release(Leaf node) {
  at(node).parent = free_;
  free_ = node;
}

void AabbTree::insert_leaf(Leaf leaf) {
  if (root_ == kNone) {
    root_ = leaf;
    at(leaf).parent = kNone;
    return;
  }
  const Leaf sibling = best_sibling(at(leaf).bounds);
  const Leaf parent = allocate();
  const Leaf grandparent = at(sibling).parent;
  at(parent).parent = grandparent;
  at(parent).child[0] = sibling;
  at(parent).child[1] = leaf;
  at(sibling).parent = parent;
  at(leaf).parent = parent;
  if (grandparent == kNone) {
    root_ = parent;
  } else {
    replace_child(grandparent, sibling, parent);
  }
  refit_upwards(parent);
}

void AabbTree::remove_leaf(Leaf leaf) {
  const Leaf parent = at(leaf).parent;
  if (parent == kNone) {
    root_ = kNone;
    return;
  }
  const Leaf sibling = at(parent).child[at(parent).child[0] == leaf ? 1 : 0];
  const Leaf grandparent = at(parent).parent;
  at(sibling).parent = grandparent;
  release(parent);
  if (grandparent == kNone) {
    root_ = sibling;
    return;
  }
  replace_child(grandparent, parent, sibling);
  refit_upwards(grandparent);
}

/// Descends while a child promises a smaller total increase of area than becoming the sibling here.
AabbTree::Leaf AabbTree::best_sibling(const Aabb& bounds) const {
  const double own = bounds.half_area();
  Leaf node = root_;
  double inherited = 0.0;  // growth of all ancestors of `node`
  while (!at(node).is_leaf()) {
    const double united = at(node).bounds.united(bounds).half_area();
    const double here = united + inherited;
    inherited += united - at(node).bounds.half_area();
    Leaf best = kNone;
    double best_bound = here;
    for (const Leaf child : at(node).child) {
      const double grown = at(child).bounds.united(bounds).half_area() + inherited;
      // A leaf costs exactly this; below an inner node at least the new leaf's own area and the growth are paid.
      const double bound = at(child).is_leaf() ? grown : grown - at(child).bounds.half_area() + own;
      if (bound < best_bound) {
        best = child;
        best_bound = bound;
      }
    }
    if (best == kNone) break;
    node = best;
  }
  return node;
}

void AabbTree::refit(Leaf node) {
  const Node& a = at(at(node).child[0]);
  const Node& b = at(at(node).child[1]);
  at(node).bounds = a.bounds.united(b.bounds);
  at(node).height = 1 + std::max(a.height, b.height);
}

void AabbTree::refit_upwards(Leaf node) {
  for (; node != kNone; node = at(node).parent) {
    refit(node);
    rotate(node);
  }
}

/// Swaps a child with a grandchild on the other side if that shrinks the inner node between them; the best of the four
/// possible swaps.
void AabbTree::rotate(Leaf node) {
  double best_gain = 0.0;
  int best_side = 0, best_grandchild = -1;
  for (int side = 0; side < 2; ++side) {
    const Node& inner = at(at(node).child[side]);
    if (inner.is_leaf()) continue;
    const Aabb& other = at(at(node).child[1 - side]).bounds;
    for (int g = 0; g < 2; ++g) {
      const double gain = inner.bounds.half_area() - other.united(at(inner.child[1 - g]).bounds).half_area();
      if (gain > best_gain) {
        best_gain = gain;
        best_side = side;
        best_grandchild = g;
      }
    }
  }
  if (best_grandchild < 0) return;
  const Leaf inner = at(node).child[best_side];
  const Leaf other = at(node).child[1 - best_side];
  const Leaf grandchild = at(inner).child[best_grandchild];
  at(inner).child[best_grandchild] = other;
  at(other).parent = inner;
  at(node).child[1 - best_side] = grandchild;
  at(grandchild).parent = node;
  refit(inner);
  refit(node);
}

void AabbTree::replace_child(Leaf parent, Leaf old_child, Leaf new_child) {
  at(parent).child[at(parent).child[0] == old_child ? 0 : 1] = new_child;
}

}  // namespace tumble
