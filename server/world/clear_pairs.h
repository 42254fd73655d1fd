// Pairs whose boxes overlap, but whose bodies are on ways, flights or rest, that keep them apart until some later step.
// They are no contacts: nothing looks at them until then, or until one of the two leaves its way. Sorted by pair.
#pragma once

#include <cstdint>
#include <vector>

#include "collision/broad_phase.h"

namespace tumble {

struct ClearPair {
  std::uint32_t a = 0, b = 0;  ///< Geometries; none of them is a surface of triangles.
  std::uint32_t body_a = 0, body_b = 0;
  std::uint32_t way_a = 0, way_b = 0;  ///< Their ways, by number.
  std::uint64_t until = 0;             ///< The step at which it is looked at again.
};

class ClearPairs {
 public:
  std::size_t size() const { return pairs_.size(); }
  bool holds(GeometryPair pair) const;

  /// Takes part from the next `settle` on; a pair that was added twice has the time that was foreseen first.
  void add(const ClearPair& pair) { incoming_.push_back(pair); }
  void settle();

  /// Takes out the pairs that are due at `step`, or one of whose bodies is on another way than was foreseen (`ways`: the
  /// present ones, by slot), and appends them to `due`, in order.
  void take_due(std::uint64_t step, const std::vector<std::uint32_t>& ways, std::vector<GeometryPair>& due);

  /// Takes out all pairs of the body.
  void forget(std::uint32_t slot);

 private:
  template <typename>
  friend struct Archived;  // its list of members, world/archive.cpp
  std::vector<ClearPair> pairs_, incoming_;
};

}  // namespace tumble
