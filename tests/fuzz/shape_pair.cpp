// See shape_pair.h.
#include "shape_pair.h"

#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "math/rotation.h"

namespace tumble::test {
namespace {

/// Reads zeros after the end.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  std::uint8_t byte() { return at_ < bytes_.size() ? bytes_[at_++] : 0; }
  unsigned below(unsigned count) { return byte() % count; }
  /// Even over low..high in 65536 steps, so that equal and round values turn up.
  double uniform(double low, double high) {
    const unsigned high_byte = byte(), low_byte = byte();
    return low + (high - low) * (high_byte * 256u + low_byte) / 65535.0;
  }
  double power_of_ten(double low, double high) { return std::pow(10.0, uniform(low, high)); }
  Vec3 vector(double low, double high) {
    Vec3 v;
    for (int i = 0; i < 3; ++i) v[i] = uniform(low, high);
    return v;
  }
  Vec3 direction() {
    if (below(4) == 0) return (below(2) == 0 ? 1.0 : -1.0) * Vec3::Unit(static_cast<int>(below(3)));
    const Vec3 v = vector(-1.0, 1.0);
    return v.norm() > 1e-3 ? Vec3(v.normalized()) : Vec3::UnitZ();
  }
  Quat rotation() {
    switch (below(4)) {
      case 0:
        return Quat::Identity();
      case 1:
        return exp_map(1.5707963267948966 * below(4) * Vec3::Unit(static_cast<int>(below(3))));
      case 2: {
        const double angle = power_of_ten(-12.0, 0.0);
        return exp_map(angle * direction());
      }
      default:
        return exp_map(vector(-3.0, 3.0));
    }
  }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

/// Three lengths [m]: alike, a plate, a needle, or one far longer.
Vec3 read_extents(ByteReader& reader) {
  const double size = reader.power_of_ten(-3.0, 3.0);
  Vec3 extents = size * reader.vector(0.2, 1.0);
  const unsigned kind = reader.below(6), axis = reader.below(3);
  const double thin = reader.power_of_ten(-3.0, 0.0);
  if (kind == 4) extents[static_cast<int>(axis)] *= thin;
  if (kind == 5) {
    extents *= thin;
    extents[static_cast<int>(axis)] /= thin;
  }
  if (kind == 3) extents.setConstant(size);
  return extents;
}

/// Points on an ellipsoid, in a box, or on a coarse grid with many in one plane.
HullPointer read_hull(ByteReader& reader) {
  const Vec3 extents = read_extents(reader);
  const unsigned kind = reader.below(3), count = 4 + reader.below(21);
  std::vector<Vec3> points;
  for (unsigned i = 0; i < count; ++i) {
    Vec3 p;
    if (kind == 0) {
      p = reader.direction();
    } else if (kind == 1) {
      p = reader.vector(-1.0, 1.0);
    } else {
      for (int k = 0; k < 3; ++k) p[k] = reader.below(3) - 1.0;
    }
    points.push_back(p.cwiseProduct(extents));
  }
  return std::make_shared<const ConvexHull>(build_convex_hull(points));
}

Shape read_shape(ByteReader& reader) {
  switch (reader.below(11)) {
    case 0:
      return HalfSpace{};
    case 1:
      return Sphere{read_extents(reader).x()};
    case 2: {
      const Vec3 extents = read_extents(reader);
      return Capsule{extents.x(), extents.z()};
    }
    case 3:
    case 4:
      return Box{read_extents(reader)};
    case 5: {
      const Vec3 extents = read_extents(reader);
      return Cylinder{extents.x(), extents.z()};
    }
    case 6: {
      const Vec3 extents = read_extents(reader);
      return Cone{extents.x(), extents.z()};
    }
    case 7:
      return Ellipsoid{read_extents(reader)};
    default:
      return read_hull(reader);
  }
}

double size_of(const Shape& shape) {
  return std::holds_alternative<HalfSpace>(shape) ? 1.0 : bounding_radius(shape);
}

/// B's place in A: on A's centre, near or inside, or touching along a direction but for a gap of next to nothing.
Vec3 read_place(ByteReader& reader, const Shape& a, const Shape& b, const Quat& q_AB) {
  const unsigned kind = reader.below(5);
  const double size = size_of(a) + size_of(b);
  const Vec3 d = reader.direction();
  if (kind == 0) return Vec3::Zero();
  if (kind == 1) return size * reader.vector(-1.0, 1.0);
  const bool endless = std::holds_alternative<HalfSpace>(a) || std::holds_alternative<HalfSpace>(b);
  const double touching = endless ? 0.0 : -separation_along(a, b, rotation_matrix(q_AB), Vec3::Zero(), d);
  const double smaller = std::min(size_of(a), size_of(b));
  const double gap = kind == 2 ? 0.0 : smaller * reader.power_of_ten(-12.0, 0.0);
  const double sign = reader.below(4) == 0 ? 1.0 : -1.0;
  return (touching + sign * gap) * d;
}

}  // namespace

std::optional<ShapePair> decode_shape_pair(std::span<const std::uint8_t> bytes) {
  ByteReader reader(bytes);
  try {
    ShapePair pair;
    pair.a = read_shape(reader);
    pair.b = reader.below(8) == 0 ? pair.a : read_shape(reader);
    const Quat q_AB = reader.rotation();
    const Pose X_AB{q_AB, read_place(reader, pair.a, pair.b, q_AB)};
    const unsigned frame = reader.below(3);
    if (frame > 0) pair.X_WA.q = reader.rotation();
    if (frame > 1) pair.X_WA.p = reader.power_of_ten(0.0, 4.0) * reader.direction();
    pair.X_WB = pair.X_WA * X_AB;
    pair.X_WB.q = normalized(pair.X_WB.q);
    const double smaller = std::min(size_of(pair.a), size_of(pair.b));
    pair.margin = reader.below(2) == 0 ? 0.0 : smaller * reader.power_of_ten(-6.0, 0.0);
    return pair;
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

}  // namespace tumble::test
