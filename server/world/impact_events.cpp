// See impact_events.h.
#include "world/impact_events.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace tumble {
namespace {

/// For a heap with the earliest on top.
bool later(const ImpactEvent& l, const ImpactEvent& r) {
  return std::tie(l.time, l.pair) > std::tie(r.time, r.pair);
}

}  // namespace

void ImpactEvents::begin_step(std::uint32_t capacity) {
  heap_.clear();
  bodies_.resize(capacity);
  for (std::uint32_t slot = 0; slot < capacity; ++slot) {
    bodies_[slot].version = 0;
    bodies_[slot].next_in_group = slot;
    bodies_[slot].count = 0;
  }
}

void ImpactEvents::set_trajectory(std::uint32_t slot, const Trajectory& trajectory) {
  bodies_[slot].trajectory = trajectory;
  ++bodies_[slot].version;
}

std::vector<std::uint32_t> ImpactEvents::group(std::uint32_t slot) const {
  std::vector<std::uint32_t> slots = {slot};
  for (std::uint32_t next = bodies_[slot].next_in_group; next != slot; next = bodies_[next].next_in_group) {
    slots.push_back(next);
  }
  std::sort(slots.begin(), slots.end());
  return slots;
}

void ImpactEvents::form_group(std::span<const std::uint32_t> slots) {
  for (std::size_t i = 0; i < slots.size(); ++i) {
    bodies_[slots[i]].next_in_group = slots[i + 1 == slots.size() ? 0 : i + 1];
  }
}

void ImpactEvents::join(std::uint32_t a, std::uint32_t b) {
  for (std::uint32_t next = bodies_[a].next_in_group; next != a; next = bodies_[next].next_in_group) {
    if (next == b) return;
  }
  // Two rings become one by exchanging successors.
  if (a != b) std::swap(bodies_[a].next_in_group, bodies_[b].next_in_group);
}

void ImpactEvents::push(double time, GeometryPair pair, std::uint32_t body_a, std::uint32_t body_b) {
  give_back({time, pair, body_a, body_b, bodies_[body_a].version, bodies_[body_b].version});
}

void ImpactEvents::give_back(const ImpactEvent& event) {
  heap_.push_back(event);
  std::push_heap(heap_.begin(), heap_.end(), later);
}

std::vector<ImpactEvent> ImpactEvents::take_until(double time) {
  std::vector<ImpactEvent> taken;
  for (const ImpactEvent* event = next(); event != nullptr && event->time <= time; event = next()) {
    taken.push_back(*event);
    pop();
  }
  return taken;
}

bool ImpactEvents::holds(const ImpactEvent& event) const {
  return bodies_[event.body_a].version == event.version_a && bodies_[event.body_b].version == event.version_b;
}

const ImpactEvent* ImpactEvents::next() {
  while (!heap_.empty() && !holds(heap_.front())) pop();
  return heap_.empty() ? nullptr : &heap_.front();
}

void ImpactEvents::pop() {
  std::pop_heap(heap_.begin(), heap_.end(), later);
  heap_.pop_back();
}

}  // namespace tumble
