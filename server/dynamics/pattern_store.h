// Patterns of factorization kept over the steps: while the same bodies touch, an island's is found again instead of made.
// Thrown away at any time: a pattern is a function of its graph, so what is kept changes no bit of any result.
#pragma once

#include <memory>

#include "dynamics/block_pattern.h"

namespace tumble {

class PatternStore {
 public:
  /// `edges` sorted, without repetitions; see BlockPattern.
  std::shared_ptr<const BlockPattern> find(std::uint32_t size, const std::vector<BlockPattern::Edge>& edges,
                                           std::uint64_t limit);
  /// Forgets what nobody asked for since the last call.
  void end_step();
  /// Since the store was made.
  std::uint64_t found() const { return found_; }
  std::uint64_t made() const { return made_; }

 private:
  struct Kept {
    std::uint64_t key;
    std::uint32_t size;
    std::uint64_t limit;
    std::vector<BlockPattern::Edge> edges;
    std::shared_ptr<const BlockPattern> pattern;
    bool used;
  };
  std::vector<Kept> kept_;  // by key
  std::uint64_t found_ = 0, made_ = 0;
};

}  // namespace tumble
