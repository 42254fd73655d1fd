// See contact_graph.h.
#include "world/contact_graph.h"

#include <algorithm>

namespace tumble {

const Contact* ContactGraph::find(GeometryPair pair) const {
  const auto late = contacts_.end() - static_cast<std::ptrdiff_t>(late_);
  const auto it = std::lower_bound(contacts_.begin(), late, pair,
                                   [](const Contact& c, GeometryPair key) { return c.pair < key; });
  if (it != late && it->pair == pair) return &*it;
  const auto found = std::find_if(late, contacts_.end(), [&](const Contact& c) { return c.pair == pair; });
  return found != contacts_.end() ? &*found : nullptr;
}

void ContactGraph::settle() {
  if (late_ == 0) return;
  const auto late = contacts_.end() - static_cast<std::ptrdiff_t>(late_);
  incoming_.assign(late, contacts_.end());
  contacts_.erase(late, contacts_.end());
  late_ = 0;
  std::sort(incoming_.begin(), incoming_.end(),
            [](const Contact& l, const Contact& r) { return l.pair < r.pair; });
  merge_incoming();
}

void ContactGraph::remove(const std::vector<std::uint32_t>& indices) {
  auto gone = indices.begin();
  std::uint32_t index = 0;
  std::erase_if(contacts_, [&](const Contact&) {
    if (gone == indices.end() || *gone != index++) return false;
    ++gone;
    return true;
  });
}

/// From the back, and only as far as the first that comes in: contacts are big.
void ContactGraph::merge_incoming() {
  std::size_t old = contacts_.size(), in = incoming_.size();
  contacts_.resize(old + in);
  while (in > 0) {
    const bool from_old = old > 0 && incoming_[in - 1].pair < contacts_[old - 1].pair;
    contacts_[old + in - 1] = from_old ? contacts_[old - 1] : incoming_[in - 1];
    --(from_old ? old : in);
  }
}

namespace {

using Impulses = std::array<Vec3, kMaxManifoldPoints>;

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

void rearrange(const Manifold& old_manifold, const Manifold& manifold, double reach, Impulses& impulse) {
  const Impulses old_impulse = impulse;
  std::array<bool, kMaxManifoldPoints> used{};
  for (int i = 0; i < manifold.count; ++i) {
    const auto point = static_cast<std::size_t>(i);
    const int from = match(old_manifold, manifold.points[point], reach, used);
    if (from < 0) {
      impulse[point].setZero();
    } else {
      used[static_cast<std::size_t>(from)] = true;
      impulse[point] = old_impulse[static_cast<std::size_t>(from)];
    }
  }
}

}  // namespace

void transport_impulses(const Manifold& old_manifold, const Manifold& manifold, const Vec3& normal_W,
                        double reach, Impulses& impulse) {
  if (!have_same_features(old_manifold, manifold)) rearrange(old_manifold, manifold, reach, impulse);
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
    if (!(impulse[i].dot(normal_W) > 0.0)) impulse[i].setZero();
  }
}

}  // namespace tumble
