// What a pair of shapes remembers between steps. Part of the state (snapshots hold it). It only decides how a query may
// end early or where a search starts: the manifold itself is a function of the shapes and their pose.
#pragma once

#include <cstdint>
#include <limits>

#include "math/types.h"

namespace tumble {

/// Frame A is the frame of the shape that is computed first: by the pair matrix of narrow_phase.cpp or, in pairs of one
/// type, by `order`. A memory belongs to one pair, always asked for in the same order.
struct PairCache {
  enum class Order : std::uint8_t { open, forwards, backwards };

  Vec3 axis_A = Vec3::Zero();  ///< Last separating axis, from A to B, unit; zero: none yet.
  double gap = 0.0;            ///< Certified lower bound of the distance at the pose below [m]; <= 0: none.
  double slack = -1.0;  ///< The kept facet wins until B has moved this far [m]; 0: only here; < 0: none.
  /// Of the manifold at the pose below [m]; NaN: none was made there.
  double margin = std::numeric_limits<double>::quiet_NaN();
  Vec3 p_AB = Vec3::Zero();  ///< Relative pose that gap, slack and margin belong to.
  Quat q_AB = Quat::Identity();
  std::uint32_t feature = 0;                 ///< Facet that won the last exact search; 0: none.
  std::uint32_t vertex_A = 0, vertex_B = 0;  ///< Start of hill climbing on hulls.
  Order order = Order::open;                 ///< Of two shapes of one type: as asked, or turned round.
};

}  // namespace tumble
