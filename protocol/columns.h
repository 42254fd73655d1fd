// Messages hold rows of bodies, contacts or hits as columns side by side: how many rows fit, and vectors among them.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tumble/state_t.hpp"

namespace tumble {

/// Rows of `size` bytes that fit into `limit` bytes beside what `message` holds already.
template <typename Message>
std::size_t rows_that_fit(std::size_t limit, std::size_t size, const Message& message = {}) {
  return (limit - static_cast<std::size_t>(message.getEncodedSize())) / size;
}

/// Position, orientation (w, x, y, z), velocity, angular velocity.
inline std::array<std::vector<double>*, 13> motion_columns(state_t& message) {
  return {&message.px, &message.py, &message.pz, &message.qw, &message.qx, &message.qy, &message.qz,
          &message.vx, &message.vy, &message.vz, &message.wx, &message.wy, &message.wz};
}

/// Appends the components of a vector of three.
template <typename Vector>
void push_components(const Vector& v, std::vector<double>& x, std::vector<double>& y,
                     std::vector<double>& z) {
  x.push_back(v[0]);
  y.push_back(v[1]);
  z.push_back(v[2]);
}

}  // namespace tumble
