// See corner_on_face.h. Squares are compared: no roots, no divisions.
#include "collision/corner_on_face.h"

namespace tumble {

double least_slope2(const StandingCorner& corner, double gap) {
  const Polytope& body = corner.body;
  const Vec3& foot = body.vertices[corner.vertex];
  double rise2 = 1.0, length2 = 1.0;
  const std::uint32_t end = body.neighbour_offsets[corner.vertex + 1];
  for (std::uint32_t k = body.neighbour_offsets[corner.vertex]; k < end; ++k) {
    const Vec3 along = body.vertices[body.neighbours[k]] - foot;
    const double rise = corner.up.dot(along), square = along.squaredNorm();
    if (!(rise > gap)) return 0.0;
    if (rise * rise * length2 < rise2 * square) rise2 = rise * rise, length2 = square;
  }
  return rise2 / length2;
}

bool holds_disc(const Polytope& polytope, std::uint32_t face, const Vec3& p, double gap, double slope2) {
  const double inside = -height_beside_face(polytope, face, p);
  return inside > 0.0 && inside * inside * slope2 > gap * gap;
}

}  // namespace tumble
