// The pairs of geometries that are near each other, with what they remember between steps. Sorted by pair, always: the
// order of solving, and so every bit of the result, is a function of the indices and not of who met whom first.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "collision/broad_phase.h"
#include "collision/narrow_phase.h"

namespace tumble {

/// One for each point of a manifold; of those that are not there, without meaning.
using Impulses = std::array<Vec3, kMaxManifoldPoints>;

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
  Impulses impulse;
  /// Moments of turning friction [N m s], likewise.
  Impulses moment;
};

/// A row of contacts in the order of their pairs. Contacts are big, so those that come and go move nothing but this order: a
/// contact keeps its place in memory as long as it is there.
class ContactGraph {
 public:
  std::size_t size() const { return order_.size(); }
  const Contact& operator[](std::size_t index) const { return places_[order_[index].place]; }
  Contact& operator[](std::size_t index) { return places_[order_[index].place]; }
  /// That of the contact with this index; cheaper.
  GeometryPair pair(std::size_t index) const { return order_[index].pair; }

  /// In their order.
  template <typename Graph>
  struct Iterator {
    auto& operator*() const { return (*graph)[index]; }
    Iterator& operator++() { return ++index, *this; }
    bool operator==(const Iterator&) const = default;
    Graph* graph;
    std::size_t index;
  };
  Iterator<const ContactGraph> begin() const { return {this, 0}; }
  Iterator<const ContactGraph> end() const { return {this, size()}; }
  Iterator<ContactGraph> begin() { return {this, 0}; }
  Iterator<ContactGraph> end() { return {this, size()}; }
  /// Calls visit(index) for each of `indices`. The first `kBytes` of a contact are fetched ahead, as many as four whole
  /// ones have: thousands of them leave the caches between two visits, and lie too far apart for the processor to foresee.
  template <std::size_t kBytes, typename Visit>
  void visit(const std::vector<std::uint32_t>& indices, Visit visit) const {
    constexpr std::size_t kAhead = 4 * sizeof(Contact) / kBytes, kLine = 64;
    for (std::size_t i = 0; i < indices.size(); ++i) {
      if (i + kAhead < indices.size()) {
        const char* next = reinterpret_cast<const char*>(&(*this)[indices[i + kAhead]]);
        for (std::size_t at = 0; at < kBytes; at += kLine) __builtin_prefetch(next + at);
      }
      visit(indices[i]);
    }
  }

  /// Inserts the pairs that are not there yet and returns how many; `added` is sorted. `make(pair)` gives the contact.
  template <typename Make>
  std::size_t insert(const std::vector<GeometryPair>& added, Make make) {
    const std::size_t before = size();
    for (const GeometryPair pair : added) {
      if (!stands_in_order(pair)) append(make(pair));
    }
    settle();
    return size() - before;
  }
  /// The same in the middle of a step: at the end, in their own order, so that the others keep their indices until
  /// `settle`.
  template <typename Make>
  std::size_t insert_late(const std::vector<GeometryPair>& added, Make make) {
    const std::size_t before = size();
    for (const GeometryPair pair : added) {
      if (!holds(pair)) append(make(pair));
    }
    return size() - before;
  }
  void settle();

  /// Removes every contact for which `gone(contact)` holds.
  template <typename Gone>
  void remove_if(Gone gone) {
    std::erase_if(order_, [&](const Entry& entry) {
      if (!gone(std::as_const(places_[entry.place]))) return false;
      free_.push_back(entry.place);
      return true;
    });
  }
  /// Removes the contacts at `indices`, ascending.
  void remove(const std::vector<std::uint32_t>& indices);

  bool holds(GeometryPair pair) const { return stands_in_order(pair) || comes_late(pair); }

 private:
  template <typename>
  friend struct Archived;  // its list of members, world/archive.cpp
  struct Entry {
    GeometryPair pair;
    std::uint32_t place;
  };
  bool stands_in_order(GeometryPair pair) const;
  bool comes_late(GeometryPair pair) const;
  void append(const Contact& contact);

  std::vector<Entry> order_, incoming_;
  std::vector<Contact> places_;
  std::vector<std::uint32_t> free_;  // of the places
  std::size_t late_ = 0;             // at the end of order_, not in order
};

/// Carries impulses and moments from the old manifold's points to the new ones: same feature first, else the nearest old
/// point within `reach` [m], each used once. New points have none; impulses that would pull are dropped with their moments.
void transport_impulses(const Manifold& old_manifold, const Manifold& manifold, const Vec3& normal_W,
                        double reach, Impulses& impulse, Impulses& moment);

}  // namespace tumble
