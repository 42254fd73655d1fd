// Groups of bodies that act on each other. Union-find over edges in their given order; the result depends on the
// indices alone, never on hashes or addresses.
#pragma once

#include <cstdint>
#include <vector>

namespace tumble {

/// Bodies by the caller's indices. An edge with an immovable end belongs to the island of its other end.
struct IslandEdge {
  static constexpr std::uint32_t kImmovable = 0xffffffffu;
  std::uint32_t a, b;  ///< Body index or kImmovable; not both immovable.
};

struct Islands {
  /// Island i: bodies[body_begin[i] .. body_begin[i+1]), ascending; edges likewise, in input order. Islands are
  /// ordered by their smallest body.
  std::vector<std::uint32_t> bodies, edges;
  std::vector<std::uint32_t> body_begin, edge_begin;
  std::size_t count() const { return body_begin.empty() ? 0 : body_begin.size() - 1; }
};

class IslandBuilder {
 public:
  /// `movable`: ascending indices < body_capacity of the bodies to group; a body without edges is an island of its own.
  void build(std::uint32_t body_capacity, const std::vector<std::uint32_t>& movable,
             const std::vector<IslandEdge>& edges, Islands& islands);

 private:
  std::uint32_t find(std::uint32_t body);
  std::vector<std::uint32_t> parent_, island_of_, cursor_;
};

}  // namespace tumble
