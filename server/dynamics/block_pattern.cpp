// See block_pattern.h. The graph is a matrix of bits: a row for each body, a bit for each neighbour not yet eliminated.
#include "dynamics/block_pattern.h"

#include <algorithm>
#include <bit>
#include <cassert>

namespace tumble {
namespace {

/// Larger islands are above any limit: their bits alone would take 2 MB.
constexpr std::uint32_t kMostLimited = 4096;

class EliminationGraph {
 public:
  EliminationGraph(std::uint32_t size, const std::vector<BlockPattern::Edge>& edges)
      : words_((size + 63) / 64), bits_(std::size_t{size} * words_), degree_(size) {
    for (const auto& [a, b] : edges) {
      assert(a != b && a < size && b < size);
      row(a)[b / 64] |= bit(b);
      row(b)[a / 64] |= bit(a);
    }
    for (std::uint32_t i = 0; i < size; ++i) degree_[i] = count(i);
  }

  /// Body of least degree, the first of equals.
  std::uint32_t next() const {
    return static_cast<std::uint32_t>(std::min_element(degree_.begin(), degree_.end()) - degree_.begin());
  }
  std::uint32_t degree(std::uint32_t body) const { return degree_[body]; }

  /// Takes the body out; its neighbours, which are appended to `neighbours`, become a clique.
  void eliminate(std::uint32_t body, std::vector<std::uint32_t>& neighbours) {
    const auto first = neighbours.size();
    const std::uint64_t* pivot = row(body);
    for (std::uint32_t w = 0; w < words_; ++w) {
      for (std::uint64_t left = pivot[w]; left != 0; left &= left - 1)
        neighbours.push_back(64 * w + static_cast<std::uint32_t>(std::countr_zero(left)));
    }
    for (auto i = first; i < neighbours.size(); ++i) {
      const std::uint32_t a = neighbours[i];
      std::uint64_t* bits = row(a);
      for (std::uint32_t w = 0; w < words_; ++w) bits[w] |= pivot[w];
      bits[a / 64] &= ~bit(a);
      bits[body / 64] &= ~bit(body);
      degree_[a] = count(a);
    }
    degree_[body] = kEliminated;
  }

 private:
  static constexpr std::uint32_t kEliminated = ~0u;
  static std::uint64_t bit(std::uint32_t i) { return std::uint64_t{1} << (i % 64); }
  std::uint64_t* row(std::uint32_t i) { return bits_.data() + std::size_t{i} * words_; }
  std::uint32_t count(std::uint32_t i) {
    const std::uint64_t* bits = row(i);
    int sum = 0;
    for (std::uint32_t w = 0; w < words_; ++w) sum += std::popcount(bits[w]);
    return static_cast<std::uint32_t>(sum);
  }

  std::uint32_t words_;
  std::vector<std::uint64_t> bits_;
  std::vector<std::uint32_t> degree_;
};

}  // namespace

BlockPattern::BlockPattern(std::uint32_t size, const std::vector<Edge>& edges, std::uint64_t limit)
    : complete_(size <= kMostLimited || limit == kNoLimit) {
  if (!complete_) return;
  EliminationGraph graph(size, edges);
  position_.resize(size);
  for (std::uint32_t k = 0; k < size; ++k) {
    const std::uint32_t best = graph.next();
    // The pivot, a column of blocks by it, and an update between every two of them.
    const std::uint64_t degree = graph.degree(best);
    products_ += 1 + degree + degree * degree;
    if (products_ > limit) {
      complete_ = false;
      return;
    }
    position_[best] = k;
    order_.push_back(best);
    begin_.push_back(block_count());
    graph.eliminate(best, rows_);
  }
  begin_.push_back(block_count());
  // A body's neighbours when it was eliminated are its column of the factor.
  for (std::uint32_t k = 0; k < size; ++k) {
    const auto first = rows_.begin() + begin_[k], last = rows_.begin() + begin_[k + 1];
    std::transform(first, last, first, [&](std::uint32_t body) { return position_[body]; });
    std::sort(first, last);
  }
  for (std::uint32_t k = 0; k < size; ++k) {
    for (std::uint32_t j = begin_[k]; j < begin_[k + 1]; ++j) {
      for (std::uint32_t i = j + 1; i < begin_[k + 1]; ++i) targets_.push_back(block(rows_[i], rows_[j]));
    }
  }
}

std::uint32_t BlockPattern::block(std::uint32_t position_a, std::uint32_t position_b) const {
  const auto [column, row] = std::minmax(position_a, position_b);
  const auto first = rows_.begin() + begin_[column], last = rows_.begin() + begin_[column + 1];
  const auto at = std::lower_bound(first, last, row);
  assert(at != last && *at == row);
  return static_cast<std::uint32_t>(at - rows_.begin());
}

}  // namespace tumble
