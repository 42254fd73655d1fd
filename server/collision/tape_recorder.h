// Writes down who met whom while faces are clipped. See clip_tape.h.
#pragma once

#include "collision/clip_tape.h"
#include "collision/manifold.h"

namespace tumble {

/// Writes a tape while a polygon is clipped. What does not fit makes it void.
class TapeRecorder {
 public:
  /// `faces`: a number of the pair of faces, not 0, of which the incident one has so many corners.
  TapeRecorder(ClipTape& tape, std::uint32_t faces, std::size_t corners)
      : tape_(tape), faces_(corners <= ClipTape::kLoop ? faces : 0), places_(corners) {}

  /// A side that has nothing to cut away.
  void skip_side(std::size_t side) {
    if (fits(side < ClipTape::kSides)) tape_.sides[side].count = 0;
  }
  /// The polygon's corners that a side meets follow, each with its place.
  void start_side(std::size_t side) {
    if (!fits(side < ClipTape::kSides)) return;
    side_ = &tape_.sides[side];
    side_->count = side_->crossings = 0;
    side_->inside = 0;
  }
  void look(std::size_t place, bool inside) {
    if (!fits(faces_ != 0 && side_->count < ClipTape::kLoop)) return;
    side_->inside = static_cast<std::uint16_t>(side_->inside | inside << side_->count);
    side_->loop[side_->count++] = static_cast<std::uint8_t>(place);
  }
  /// Returns the place of the crossing.
  std::size_t cross(std::size_t from, std::size_t to) {
    if (fits(faces_ != 0 && side_->crossings < ClipTape::kCut && places_ < ClipTape::kPlaces)) {
      side_->crossing[side_->crossings++] = {static_cast<std::uint8_t>(from), static_cast<std::uint8_t>(to)};
    }
    return places_++;
  }
  /// An edge passes a side within the tolerance: too fine for the tape.
  void touch() { faces_ = 0; }
  /// A corner that is left at the end. More than a manifold holds are thinned out, which depends on lengths.
  void leave(std::size_t index, std::size_t place, std::uint32_t name) {
    if (!fits(index < static_cast<std::size_t>(kMaxManifoldPoints))) return;
    tape_.left[index] = static_cast<std::uint8_t>(place);
    tape_.names[index] = name;
  }
  void finish(std::size_t count) {
    tape_.count = static_cast<std::uint8_t>(count);
    tape_.faces = faces_;
  }

 private:
  bool fits(bool yes) {
    if (!yes) faces_ = 0;
    return yes;
  }

  ClipTape& tape_;
  ClipTape::Side* side_ = nullptr;
  std::uint32_t faces_;
  std::size_t places_;
};

/// Where no tape is wanted.
struct NoRecorder {
  static void skip_side(std::size_t) {}
  static void start_side(std::size_t) {}
  static void look(std::size_t, bool) {}
  static std::size_t cross(std::size_t, std::size_t) { return 0; }
  static void touch() {}
  static void leave(std::size_t, std::size_t, std::uint32_t) {}
  static void finish(std::size_t) {}
};

}  // namespace tumble
