// The pairs of geometries that are near each other, with what they remember between steps. Sorted by pair, always: the
// order of solving, and so every bit of the result, is a function of the indices and not of who met whom first.
#pragma once

#include <array>
#include <vector>

#include "collision/broad_phase.h"
#include "collision/narrow_phase.h"

namespace tumble {

struct Contact {
  GeometryPair pair;
  std::uint32_t body_a = 0, body_b = 0;
  double friction = 0.0, restitution = 0.0;
  double rolling = 0.0, torsional = 0.0;  ///< [m]
  double threshold = 0.0;                 ///< [m/s] impacts slower than it do not bounce.
  /// Fast: crosses a good part of the smaller geometry in a step. Flies: no part of the smooth problem; the two meet,
  /// if at all, in an impact.
  bool fast = false, flies = false;
  Manifold manifold;
  Vec3 normal_W = Vec3::UnitZ();  ///< The manifold's normal in W at the last query.
  PairCache cache;
  /// Impulses of the last solve on b at each manifold point, as vectors in W [N s]: the warm start.
  std::array<Vec3, kMaxManifoldPoints> impulse;
  /// Moments of turning friction [N m s], likewise.
  std::array<Vec3, kMaxManifoldPoints> moment;
};

class ContactGraph {
 public:
  /// Inserts the pairs that are not there yet and returns how many; `added` is sorted. `make(pair)` gives the contact.
  template <typename Make>
  std::size_t insert(const std::vector<GeometryPair>& added, Make make) {
    incoming_.clear();
    for (const GeometryPair pair : added) {
      if (!find(pair)) incoming_.push_back(make(pair));
    }
    merge_incoming();
    return incoming_.size();
  }
  /// The same in the middle of a step: at the end, in their own order, so that the others keep their places until
  /// `settle`.
  template <typename Make>
  std::size_t insert_late(const std::vector<GeometryPair>& added, Make make) {
    const std::size_t before = contacts_.size();
    for (const GeometryPair pair : added) {
      if (find(pair)) continue;
      contacts_.push_back(make(pair));
      ++late_;
    }
    return contacts_.size() - before;
  }
  void settle();

  /// Removes every contact for which `gone(contact)` holds; returns how many.
  template <typename Gone>
  std::size_t remove_if(Gone gone) {
    return static_cast<std::size_t>(std::erase_if(contacts_, gone));
  }

  /// Removes the contacts at `indices`, ascending.
  void remove(const std::vector<std::uint32_t>& indices);

  const Contact* find(GeometryPair pair) const;
  Contact* find(GeometryPair pair) {
    return const_cast<Contact*>(static_cast<const ContactGraph&>(*this).find(pair));
  }
  /// Calls visit(index) for each of `indices`. The first `kBytes` of a contact are fetched ahead, as many as four whole
  /// ones have: thousands of them leave the caches between two visits, and lie too far apart for the processor to foresee.
  template <std::size_t kBytes, typename Visit>
  void visit(const std::vector<std::uint32_t>& indices, Visit visit) const {
    constexpr std::size_t kAhead = 4 * sizeof(Contact) / kBytes, kLine = 64;
    for (std::size_t i = 0; i < indices.size(); ++i) {
      if (i + kAhead < indices.size()) {
        const char* next = reinterpret_cast<const char*>(&contacts_[indices[i + kAhead]]);
        for (std::size_t at = 0; at < kBytes; at += kLine) __builtin_prefetch(next + at);
      }
      visit(indices[i]);
    }
  }

  std::vector<Contact>& all() { return contacts_; }
  const std::vector<Contact>& all() const { return contacts_; }

 private:
  template <typename>
  friend struct Archived;  // its list of members, world/archive.cpp
  void merge_incoming();
  std::vector<Contact> contacts_, incoming_;
  std::size_t late_ = 0;  // at the end of contacts_, not in order
};

/// Carries impulses from the old manifold's points to the new ones: same feature first, else the nearest old point
/// within `reach` [m], each used once; impulses that would pull are dropped.
void transport_impulses(const Manifold& old_manifold, const Manifold& manifold, const Vec3& normal_W,
                        double reach, std::array<Vec3, kMaxManifoldPoints>& impulse);

}  // namespace tumble
