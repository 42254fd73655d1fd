// State as bytes and back, with cereal: little-endian, doubles to the bit. Every type lists its members once, for both
// ways, by taking itself apart in a structured binding: a member that the list lacks does not compile. The archives are
// our own, on plain memory: cereal's go through a stream, whose call for every number costs several times the number.
#pragma once

#include <bit>
#include <cereal/cereal.hpp>
#include <cereal/types/array.hpp>
#include <cereal/types/map.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/tuple.hpp>
#include <cereal/types/utility.hpp>
#include <cereal/types/variant.hpp>
#include <cereal/types/vector.hpp>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

#include "math/pose.h"

namespace Eigen {

template <typename Archive, int kRows, int kColumns>
void serialize(Archive& archive, Matrix<double, kRows, kColumns>& m) {
  archive.transfer(m.data(), sizeof(double) * static_cast<std::size_t>(kRows * kColumns));
}

template <typename Archive>
void serialize(Archive& archive, Quaterniond& q) {
  archive(q.coeffs());
}

}  // namespace Eigen

namespace tumble {

static_assert(std::endian::native == std::endian::little);

/// Bytes of what is made of numbers without gaps: written as it lies in memory. 0: of everything else.
template <typename T>
inline constexpr std::size_t kFlatBytes = std::is_arithmetic_v<T> || std::is_enum_v<T> ? sizeof(T) : 0;
template <int kRows, int kColumns>
inline constexpr std::size_t kFlatBytes<Eigen::Matrix<double, kRows, kColumns>> =
    kRows > 0 && kColumns > 0 ? sizeof(Eigen::Matrix<double, kRows, kColumns>) : 0;
template <>
inline constexpr std::size_t kFlatBytes<Quat> = sizeof(Quat);
template <typename T>
inline constexpr bool kIsFlat = kFlatBytes<std::remove_cvref_t<T>> != 0;

/// Overwrites `bytes`, whose memory it uses again; they are whole once the archive is gone.
class OutputArchive : public cereal::OutputArchive<OutputArchive, cereal::AllowEmptyClassElision> {
  using Base = cereal::OutputArchive<OutputArchive, cereal::AllowEmptyClassElision>;

 public:
  explicit OutputArchive(std::string& bytes) : Base(this), bytes_(bytes) {}
  OutputArchive(const OutputArchive&) = delete;
  OutputArchive& operator=(const OutputArchive&) = delete;
  ~OutputArchive() override { bytes_.resize(static_cast<std::size_t>(at_ - bytes_.data())); }

  template <typename... Types>
  OutputArchive& operator()(Types&&... objects) {
    if constexpr ((... && kIsFlat<Types>)) {
      write_flat(objects...);
    } else if constexpr (sizeof...(objects) == 1) {
      (Base::operator()(objects), ...);
    } else {
      ((*this)(objects), ...);
    }
    return *this;
  }

  [[gnu::always_inline]] void transfer(const void* data, std::size_t size) {
    if (static_cast<std::size_t>(end_ - at_) < size) grow(size);
    std::memcpy(at_, data, size);
    at_ += size;
  }

 private:
  /// Those in a row ask for their place once.
  template <typename... Flat>
  [[gnu::always_inline]] void write_flat(const Flat&... objects) {
    constexpr std::size_t size = (... + kFlatBytes<Flat>);
    if (static_cast<std::size_t>(end_ - at_) < size) grow(size);
    char* at = at_;  // a copy: what is written might be at_ itself, for all the compiler knows
    ((std::memcpy(at, static_cast<const void*>(&objects), kFlatBytes<Flat>), at += kFlatBytes<Flat>), ...);
    at_ = at;
  }
  [[gnu::noinline]] void grow(std::size_t size) {
    const auto used = static_cast<std::size_t>(at_ - bytes_.data());
    bytes_.resize(2 * bytes_.size() + size);
    at_ = bytes_.data() + used;
    end_ = bytes_.data() + bytes_.size();
  }

  std::string& bytes_;
  char* at_ = bytes_.data();
  char* end_ = bytes_.data() + bytes_.size();
};

/// Throws std::runtime_error if it is asked for more than there is.
class InputArchive : public cereal::InputArchive<InputArchive, cereal::AllowEmptyClassElision> {
 public:
  explicit InputArchive(std::string_view bytes)
      : cereal::InputArchive<InputArchive, cereal::AllowEmptyClassElision>(this), rest_(bytes) {}

  void transfer(void* data, std::size_t size) {
    if (rest_.size() < size) throw std::runtime_error("it ends too early");
    std::memcpy(data, rest_.data(), size);
    rest_.remove_prefix(size);
  }

 private:
  std::string_view rest_;
};

template <typename Archive>
concept OurArchive = std::is_same_v<Archive, OutputArchive> || std::is_same_v<Archive, InputArchive>;

template <OurArchive Archive, typename Number>
requires std::is_arithmetic_v<Number>
[[gnu::always_inline]] inline void serialize(Archive& archive, Number& number) {
  archive.transfer(&number, sizeof number);
}
template <OurArchive Archive, typename T>
void serialize(Archive& archive, cereal::BinaryData<T>& block) {
  if (block.size > 0) archive.transfer(block.data, static_cast<std::size_t>(block.size));
}
template <OurArchive Archive, typename T>
void serialize(Archive& archive, cereal::SizeTag<T>& tag) {
  archive(tag.size);
}
template <OurArchive Archive, typename T>
void serialize(Archive& archive, cereal::NameValuePair<T>& pair) {
  archive(pair.value);
}

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

CEREAL_SETUP_ARCHIVE_TRAITS(tumble::InputArchive, tumble::OutputArchive)
