// See block_pattern.h. Plain elimination on sorted neighbour lists: islands have at most some hundred bodies.
#include "dynamics/block_pattern.h"

#include <algorithm>
#include <cassert>

namespace tumble {
namespace {

using Neighbours = std::vector<std::vector<std::uint32_t>>;  // sorted

void insert_sorted(std::vector<std::uint32_t>& list, std::uint32_t value) {
  const auto at = std::lower_bound(list.begin(), list.end(), value);
  if (at == list.end() || *at != value) list.insert(at, value);
}

void erase_sorted(std::vector<std::uint32_t>& list, std::uint32_t value) {
  list.erase(std::lower_bound(list.begin(), list.end(), value));
}

/// Takes `row` out of the graph; its neighbours become a clique.
void eliminate(std::uint32_t row, Neighbours& graph) {
  for (const std::uint32_t a : graph[row]) {
    erase_sorted(graph[a], row);
    for (const std::uint32_t b : graph[row]) {
      if (a != b) insert_sorted(graph[a], b);
    }
  }
}

}  // namespace

BlockPattern::BlockPattern(std::uint32_t size, const std::vector<Edge>& edges, std::uint64_t limit)
    : position_(size, size) {
  Neighbours graph(size);
  for (const auto& [a, b] : edges) {
    assert(a != b && a < size && b < size);
    insert_sorted(graph[a], b);
    insert_sorted(graph[b], a);
  }
  for (std::uint32_t k = 0; k < size; ++k) {
    std::uint32_t best = size;
    for (std::uint32_t row = 0; row < size; ++row) {
      if (position_[row] != size) continue;
      if (best == size || graph[row].size() < graph[best].size()) best = row;
    }
    // The pivot, a column of blocks by it, and an update between every two of them.
    const std::uint64_t degree = graph[best].size();
    products_ += 1 + degree + degree * degree;
    if (products_ > limit) {
      complete_ = false;
      return;
    }
    position_[best] = k;
    order_.push_back(best);
    eliminate(best, graph);
  }
  // What is left of a row's list when it was eliminated are its later neighbours: its column of the factor.
  for (std::uint32_t k = 0; k < size; ++k) {
    begin_.push_back(block_count());
    for (const std::uint32_t row : graph[order_[k]]) rows_.push_back(position_[row]);
    std::sort(rows_.begin() + begin_.back(), rows_.end());
  }
  begin_.push_back(block_count());
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
