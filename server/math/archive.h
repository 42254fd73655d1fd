// State as bytes and back, with cereal: little-endian, doubles to the bit. Every type lists its members once, for both
// ways, by taking itself apart in a structured binding: a member that the list lacks does not compile.
#pragma once

#include <cereal/archives/portable_binary.hpp>
#include <cereal/types/array.hpp>
#include <cereal/types/map.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/tuple.hpp>
#include <cereal/types/utility.hpp>
#include <cereal/types/variant.hpp>
#include <cereal/types/vector.hpp>

#include "math/pose.h"

namespace Eigen {

template <typename Archive, int kRows, int kColumns>
void serialize(Archive& archive, Matrix<double, kRows, kColumns>& m) {
  archive(cereal::binary_data(m.data(), sizeof(double) * static_cast<std::size_t>(kRows * kColumns)));
}

template <typename Archive>
void serialize(Archive& archive, Quaterniond& q) {
  archive(q.coeffs());
}

}  // namespace Eigen

namespace tumble {

using OutputArchive = cereal::PortableBinaryOutputArchive;
using InputArchive = cereal::PortableBinaryInputArchive;

/// A class with private state befriends this; its specialisation has `members(archive, object)`.
template <typename T>
struct Archived;

template <typename Archive, typename T>
requires requires(Archive& archive, T& object) {
  Archived<T>::members(archive, object);
}
void serialize(Archive& archive, T& object) {
  Archived<T>::members(archive, object);
}

template <typename Archive>
void serialize(Archive& archive, Pose& pose) {
  auto& [q, p] = pose;
  archive(q, p);
}

}  // namespace tumble
