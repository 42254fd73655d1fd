// See island.h. A root is always the smallest body of its tree, so roots met in ascending order number the islands.
#include "dynamics/island.h"

#include <algorithm>
#include <cassert>

namespace tumble {
namespace {

/// Turns counts, stored one place to the right, into the begin of each slice.
void accumulate(std::vector<std::uint32_t>& begin) {
  for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
}

}  // namespace

std::uint32_t IslandBuilder::find(std::uint32_t body) {
  while (parent_[body] != body) {
    parent_[body] = parent_[parent_[body]];  // halves the path, which keeps later walks short
    body = parent_[body];
  }
  return body;
}

void IslandBuilder::build(std::uint32_t body_capacity, const std::vector<std::uint32_t>& movable,
                          const std::vector<IslandEdge>& edges, Islands& islands) {
  assert(std::is_sorted(movable.begin(), movable.end()));
  parent_.assign(body_capacity, IslandEdge::kImmovable);
  island_of_.resize(body_capacity);
  for (const std::uint32_t body : movable) parent_[body] = body;
  for (const IslandEdge& edge : edges) {
    assert(edge.a != IslandEdge::kImmovable || edge.b != IslandEdge::kImmovable);
    if (edge.a == IslandEdge::kImmovable || edge.b == IslandEdge::kImmovable) continue;
    assert(parent_[edge.a] != IslandEdge::kImmovable && parent_[edge.b] != IslandEdge::kImmovable);
    const auto [low, high] = std::minmax({find(edge.a), find(edge.b)});
    parent_[high] = low;
  }

  islands.body_begin.assign(1, 0);
  for (const std::uint32_t body : movable) {
    const std::uint32_t root = find(body);
    if (root == body) {
      island_of_[body] = static_cast<std::uint32_t>(islands.body_begin.size() - 1);
      islands.body_begin.push_back(0);
    }
    island_of_[body] = island_of_[root];
    ++islands.body_begin[island_of_[body] + 1];
  }
  const auto island_of_edge = [this](const IslandEdge& edge) {
    return island_of_[edge.a == IslandEdge::kImmovable ? edge.b : edge.a];
  };
  islands.edge_begin.assign(islands.body_begin.size(), 0);
  for (const IslandEdge& edge : edges) ++islands.edge_begin[island_of_edge(edge) + 1];
  accumulate(islands.body_begin);
  accumulate(islands.edge_begin);

  islands.bodies.resize(movable.size());
  cursor_.assign(islands.body_begin.begin(), islands.body_begin.end());
  for (const std::uint32_t body : movable) islands.bodies[cursor_[island_of_[body]]++] = body;
  islands.edges.resize(edges.size());
  cursor_.assign(islands.edge_begin.begin(), islands.edge_begin.end());
  for (std::uint32_t e = 0; e < edges.size(); ++e) islands.edges[cursor_[island_of_edge(edges[e])]++] = e;
}

}  // namespace tumble
