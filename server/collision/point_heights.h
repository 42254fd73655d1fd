// Heights of one point over every face of a polytope [m]. Of a point of another body they are upper bounds of what the faces
// separate from that.
#pragma once

#include <array>

#include "collision/polytope.h"

namespace tumble {

class PointHeights {
 public:
  /// Fours of faces whose heights are kept; those of larger hulls are computed again where needed.
  static constexpr std::size_t kKeptFours = 128;

  PointHeights() {}  // not defaulted: `{}` would clear thousands of bytes

  /// Returns the highest face, the nearest one of a body that the point is in.
  std::uint32_t measure(const Polytope& polytope, const Vec3& point) {
    polytope_ = &polytope;
    point_ = point;
    FirstLowest deepest;
    for (std::size_t i = 0; i < polytope.face_fours.size(); ++i) {
      const Polytope::FourFaces& face = polytope.face_fours[i];
      const Four depth = face.offset - dot(face.normal, point);
      if (i < kKeptFours) store_four(-depth, &heights_[4 * i]);
      deepest.look_at(depth);
    }
    return deepest.index();
  }
  double operator[](std::size_t face) const {
    return face < 4 * kKeptFours ? heights_[face] : height_over(face);
  }
  /// The heights of face 4 i and the three after it; after the last face the first again.
  Four four_from(std::size_t i) const {
    if (i < kKeptFours) return load_four(&heights_[4 * i]);
    return dot(polytope_->face_fours[i].normal, point_) - polytope_->face_fours[i].offset;
  }

 private:
  double height_over(std::size_t i) const {
    return polytope_->faces[i].normal.dot(point_) - polytope_->faces[i].offset;
  }
  const Polytope* polytope_ = nullptr;
  Vec3 point_ = Vec3::Zero();
  std::array<double, 4 * kKeptFours> heights_;
};

}  // namespace tumble
