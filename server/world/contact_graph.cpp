// See contact_graph.h.
#include "world/contact_graph.h"

#include <algorithm>

namespace tumble {

bool ContactGraph::stands_in_order(GeometryPair pair) const {
  const auto late = order_.end() - static_cast<std::ptrdiff_t>(late_);
  const auto it = std::lower_bound(order_.begin(), late, pair,
                                   [](const Entry& entry, GeometryPair key) { return entry.pair < key; });
  return it != late && it->pair == pair;
}

bool ContactGraph::comes_late(GeometryPair pair) const {
  const auto late = order_.end() - static_cast<std::ptrdiff_t>(late_);
  return std::any_of(late, order_.end(), [&](const Entry& entry) { return entry.pair == pair; });
}

void ContactGraph::append(const Contact& contact) {
  if (free_.empty()) {
    free_.push_back(static_cast<std::uint32_t>(places_.size()));
    places_.emplace_back();
  }
  order_.push_back({contact.pair, free_.back()});
  places_[free_.back()] = contact;
  free_.pop_back();
  ++late_;
}

/// From the back, and only as far as the first that comes in.
void ContactGraph::settle() {
  if (late_ == 0) return;
  const auto by_pair = [](const Entry& l, const Entry& r) { return l.pair < r.pair; };
  incoming_.assign(order_.end() - static_cast<std::ptrdiff_t>(late_), order_.end());
  std::sort(incoming_.begin(), incoming_.end(), by_pair);
  std::size_t old = order_.size() - late_, in = late_;
  while (in > 0) {
    const bool from_old = old > 0 && by_pair(incoming_[in - 1], order_[old - 1]);
    order_[old + in - 1] = from_old ? order_[old - 1] : incoming_[in - 1];
    --(from_old ? old : in);
  }
  late_ = 0;
}

void ContactGraph::remove(const std::vector<std::uint32_t>& indices) {
  auto gone = indices.begin();
  std::uint32_t index = 0;
  remove_if([&](const Contact&) {
    if (gone == indices.end() || *gone != index++) return false;
    ++gone;
    return true;
  });
}

namespace {

/// Index of the old point that continues `point`, or -1.
int match(const Manifold& old_manifold, const ManifoldPoint& point, double reach,
          const std::array<bool, kMaxManifoldPoints>& used) {
  int best = -1;
  double nearest = reach * reach;
  for (int i = 0; i < old_manifold.count; ++i) {
    if (used[static_cast<std::size_t>(i)]) continue;
    const ManifoldPoint& old_point = old_manifold.points[static_cast<std::size_t>(i)];
    if (old_point.feature == point.feature) return i;
    const double distance = (old_point.p_A - point.p_A).squaredNorm();
    if (distance < nearest) {
      nearest = distance;
      best = i;
    }
  }
  return best;
}

bool have_same_features(const Manifold& manifold, const Manifold& other) {
  if (manifold.count != other.count) return false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
    if (manifold.points[i].feature != other.points[i].feature) return false;
  }
  return true;
}

/// For each new point the old one that it continues, or -1.
std::array<int, kMaxManifoldPoints> match_all(const Manifold& old_manifold, const Manifold& manifold,
                                              double reach) {
  std::array<int, kMaxManifoldPoints> from{};
  std::array<bool, kMaxManifoldPoints> used{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
    from[i] = match(old_manifold, manifold.points[i], reach, used);
    if (from[i] >= 0) used[static_cast<std::size_t>(from[i])] = true;
  }
  return from;
}

void rearrange(const std::array<int, kMaxManifoldPoints>& from, int count, Impulses& impulse) {
  const Impulses old_impulse = impulse;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
    impulse[i] = from[i] < 0 ? Vec3(Vec3::Zero()) : old_impulse[static_cast<std::size_t>(from[i])];
}

}  // namespace

void transport_impulses(const Manifold& old_manifold, const Manifold& manifold, const Vec3& normal_W,
                        double reach, Impulses& impulse, Impulses& moment) {
  if (!have_same_features(old_manifold, manifold)) {
    const auto from = match_all(old_manifold, manifold, reach);
    rearrange(from, manifold.count, impulse);
    rearrange(from, manifold.count, moment);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
    if (impulse[i].dot(normal_W) > 0.0) continue;
    impulse[i].setZero();
    moment[i].setZero();
  }
}

}  // namespace tumble
