// What triangle meshes and height fields have in common: a fixed, one-sided surface of triangles, so that one mid phase
// and one narrow phase serve both. Outside is where a triangle's corners run counter-clockwise. Everything in the
// surface's own frame S, lengths in [m].
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "collision/aabb.h"

namespace tumble {

/// How the surface goes on beyond an edge of a triangle.
enum class Bend : std::uint8_t {
  open,     ///< It ends: the edge counts as the rim of a wall at right angles to the triangle.
  flat,     ///< It goes on in the same plane, up to kFlatBend.
  concave,  ///< It rises towards the outside: a valley.
  convex,   ///< It falls away: a ridge.
};

/// Sine of the angle below which two neighbours are one plane: less than the rounding of meshes stored in single
/// precision, and 1 um of sagitta over a metre at most.
inline constexpr double kFlatBend = 1e-5;

struct SurfaceTriangle {
  std::array<Vec3, 3> corner;
  Vec3 normal;                          ///< Unit, outward.
  std::array<std::uint32_t, 3> vertex;  ///< The corners' indices in the surface.
};

/// What lies across the edges of a triangle. Edge k runs from corner k to corner k + 1 (mod 3).
struct TriangleNeighbours {
  std::array<Bend, 3> bend;
  std::array<Vec3, 3> beyond;         ///< Far corner of the neighbour across edge k; undefined if open.
  std::array<Vec3, 3> beyond_normal;  ///< The neighbour's normal; undefined if open.
};

/// The bend between a triangle with this normal and a neighbour across the edge from tail to head.
Bend classify_bend(const Vec3& normal, const Vec3& tail, const Vec3& head, const Vec3& beyond,
                   const Vec3& beyond_normal);

/// A function that is told triangles, one after the other: anything that can be called with an index. Only referred to,
/// so it takes no memory and is for passing on, not for keeping (the idea of function_ref, WG21 P0792).
class TriangleVisitor {
 public:
  template <typename Visit>
  TriangleVisitor(const Visit& visit)
      : visit_(&visit), call_([](const void* object, std::uint32_t triangle) {
          (*static_cast<const Visit*>(object))(triangle);
        }) {}
  void operator()(std::uint32_t triangle) const { call_(visit_, triangle); }

 private:
  const void* visit_;
  void (*call_)(const void* object, std::uint32_t triangle);
};

class TriangleSurface {
 public:
  virtual ~TriangleSurface() = default;
  virtual std::uint32_t triangle_count() const = 0;
  virtual SurfaceTriangle triangle(std::uint32_t index) const = 0;
  /// Of a triangle. Most queries end before they need to know.
  virtual TriangleNeighbours neighbours(std::uint32_t index) const = 0;
  /// True if no vertex joined to `vertex` by an edge lies further along d (unit) than it: a plane normal to d touches
  /// the surface there without cutting it. The angle by which a neighbour may rise is kTopTolerance.
  virtual bool is_top(std::uint32_t vertex, const Vec3& d) const = 0;
  /// Writes the vertices joined to `vertex` by an edge, as many as fit; returns how many.
  virtual std::size_t ring(std::uint32_t vertex, std::span<Vec3> others) const = 0;
  /// Calls the visitor with each triangle whose bounds meet `bounds`, in an order of its own.
  virtual void visit(const Aabb& bounds, TriangleVisitor visitor) const = 0;
  /// Appends them, ascending.
  void query(const Aabb& bounds, std::vector<std::uint32_t>& triangles) const;

  const Aabb& bounds() const { return bounds_; }
  /// Largest distance of a vertex from S's origin.
  double radius() const { return radius_; }

  static constexpr double kTopTolerance = 1e-9;  // [rad]

 protected:
  TriangleSurface() = default;
  TriangleSurface(const TriangleSurface&) = default;
  TriangleSurface& operator=(const TriangleSurface&) = default;

  Aabb bounds_;
  double radius_ = 0.0;
};

/// True if `other` does not rise above a plane through p normal to d (unit) by more than kTopTolerance.
inline bool stays_below(const Vec3& other, const Vec3& p, const Vec3& d) {
  const Vec3 along = other - p;
  const double rise = d.dot(along);
  return rise <= 0.0 ||
         rise * rise <= TriangleSurface::kTopTolerance * TriangleSurface::kTopTolerance * along.squaredNorm();
}

}  // namespace tumble
