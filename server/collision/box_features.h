// The features of boxes by which contact points of their faces are named, tabulated beforehand. Corners are numbered by the
// signs of their coordinates: bit k is set on the upper side of axis k.
#pragma once

#include <array>

#include "collision/feature_name.h"

namespace tumble {

/// Features of a box: its twelve edges, each by the axis it lies along and the corner it starts from, its corners, and its
/// inside for a point that only the other body names.
constexpr std::uint8_t edge_at(std::uint32_t axis, std::uint32_t corner) {
  return static_cast<std::uint8_t>(8 * axis + (corner & ~(1u << axis)));
}
inline constexpr std::uint8_t kFirstBoxCorner = 24, kInsideBox = 32, kBoxFeatures = 33;
constexpr std::uint8_t corner_at(std::uint32_t corner) {
  return static_cast<std::uint8_t>(kFirstBoxCorner + corner);
}

constexpr std::uint32_t name_of(std::uint32_t a, std::uint32_t b) {
  if (a >= kFirstBoxCorner && a < kInsideBox) return name_vertex(true, a - kFirstBoxCorner);
  if (b >= kFirstBoxCorner && b < kInsideBox) return name_vertex(false, b - kFirstBoxCorner);
  return name_crossing(a % 8, a % 8 | 1u << a / 8 % 3, b % 8, b % 8 | 1u << b / 8 % 3);
}
/// Of a feature of A and one of B.
inline constexpr auto kBoxNames = [] {
  std::array<std::array<std::uint32_t, kBoxFeatures>, kBoxFeatures> names{};
  for (std::uint32_t a = 0; a < kBoxFeatures; ++a) {
    for (std::uint32_t b = 0; b < kBoxFeatures; ++b) names[a][b] = name_of(a, b);
  }
  return names;
}();

/// Corner of a box across axis k on its upper or lower side, on the upper one of axis k + 1, k + 2 or not (cyclic).
constexpr std::uint32_t corner_of(std::uint32_t k, bool upper, bool upper1, bool upper2) {
  return (upper ? 1u << k : 0u) | (upper1 ? 1u << (k + 1) % 3 : 0u) | (upper2 ? 1u << (k + 2) % 3 : 0u);
}

/// Of a reference face across axis k, x and y along the axes k + 1 and k + 2: its parts as RectangleClip numbers them.
using ReferenceFeatures = std::array<std::uint8_t, 9>;
constexpr ReferenceFeatures reference_features(std::uint32_t k, bool upper) {
  const std::array<std::uint32_t, 4> corners = {
      corner_of(k, upper, true, true), corner_of(k, upper, false, true), corner_of(k, upper, false, false),
      corner_of(k, upper, true, false)};
  const std::uint32_t k1 = (k + 1) % 3, k2 = (k + 2) % 3;
  return {edge_at(k2, corners[0]), edge_at(k1, corners[1]), edge_at(k2, corners[2]),
          edge_at(k1, corners[3]), corner_at(corners[0]),   corner_at(corners[1]),
          corner_at(corners[2]),   corner_at(corners[3]),   kInsideBox};
}

/// Of an incident face, e1 along axis k + 1, turned round on the lower side, and e2 along k + 2: what the places of
/// RectangleClip lie on.
using IncidentFeatures = std::array<std::uint8_t, 16>;
constexpr IncidentFeatures incident_features(std::uint32_t k, bool upper) {
  const std::array<std::uint32_t, 4> corners = {
      corner_of(k, upper, !upper, false), corner_of(k, upper, upper, false), corner_of(k, upper, upper, true),
      corner_of(k, upper, !upper, true)};
  const std::uint32_t k1 = (k + 1) % 3, k2 = (k + 2) % 3;
  const std::array<std::uint8_t, 4> edges = {edge_at(k1, corners[0]), edge_at(k2, corners[1]),
                                             edge_at(k1, corners[2]), edge_at(k2, corners[3])};
  IncidentFeatures features{};
  for (std::size_t i = 0; i < 4; ++i) {
    features[i] = corner_at(corners[i]);
    features[4 + i] = features[8 + i] = edges[i];
    features[12 + i] = kInsideBox;
  }
  return features;
}

/// Of the face across axis k on the lower or upper side.
template <auto make_features>
constexpr auto for_every_face() {
  std::array<std::array<decltype(make_features(0, false)), 2>, 3> features{};
  for (std::uint32_t k = 0; k < 3; ++k) features[k] = {make_features(k, false), make_features(k, true)};
  return features;
}
inline constexpr auto kReferenceFeatures = for_every_face<reference_features>();
inline constexpr auto kIncidentFeatures = for_every_face<incident_features>();

}  // namespace tumble
