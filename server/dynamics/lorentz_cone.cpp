// See lorentz_cone.h. Determinants are products of differences, never differences of squares: near the boundary, where
// the solver ends, only these keep their digits.
#include "dynamics/lorentz_cone.h"

#include <algorithm>
#include <cmath>

namespace tumble {
namespace {

double length_of_tail(const Vec3& x) {
  return std::sqrt(x.y() * x.y() + x.z() * x.z());
}

}  // namespace

Vec3 cone_product(const Vec3& x, const Vec3& y) {
  return {x.dot(y), x.x() * y.y() + y.x() * x.y(), x.x() * y.z() + y.x() * x.z()};
}

Vec3 cone_divide(const Vec3& r, const Vec3& l) {
  const double x0 = (l.x() * r.x() - l.y() * r.y() - l.z() * r.z()) / cone_determinant(l);
  return {x0, (r.y() - x0 * l.y()) / l.x(), (r.z() - x0 * l.z()) / l.x()};
}

double cone_determinant(const Vec3& x) {
  const double tail = length_of_tail(x);
  return std::max(1e-300, (x.x() - tail) * (x.x() + tail));
}

double cone_step(const Vec3& x, const Vec3& d) {
  // The least positive root of det(x + a d) = A a^2 + 2 B a + C, and the apex.
  const double A = d.x() * d.x() - d.y() * d.y() - d.z() * d.z();
  const double B = x.x() * d.x() - x.y() * d.y() - x.z() * d.z();
  const double C = cone_determinant(x);
  const double D = B * B - A * C;
  double step = kInfinity;
  if (B < 0.0 && D >= 0.0) {
    step = C / (std::sqrt(D) - B);
  } else if (B >= 0.0 && A < 0.0) {
    step = (-B - std::sqrt(D)) / A;
  }
  return d.x() < 0.0 ? std::min(step, -x.x() / d.x()) : step;
}

ConeScaling make_cone_scaling(const Vec3& s, const Vec3& z) {
  const double size_s = std::sqrt(cone_determinant(s)), size_z = std::sqrt(cone_determinant(z));
  const Vec3 unit_s = s / size_s, unit_z = z / size_z;
  const double gamma = std::sqrt(0.5 * (1.0 + unit_s.dot(unit_z)));
  const Vec3 reflected(unit_z.x(), -unit_z.y(), -unit_z.z());
  const Vec3 w = (unit_s + reflected) / (2.0 * gamma);
  const double eta2 = size_s / size_z, eta = std::sqrt(eta2);

  ConeScaling scaling;
  const double share = 1.0 / (1.0 + w.x());
  scaling.W << w.x(), w.y(), w.z(),                               //
      w.y(), 1.0 + share * w.y() * w.y(), share * w.y() * w.z(),  //
      w.z(), share * w.y() * w.z(), 1.0 + share * w.z() * w.z();
  scaling.W *= eta;
  const Vec3 v(w.x(), -w.y(), -w.z());
  scaling.inverse_square = 2.0 * v * v.transpose();
  scaling.inverse_square.diagonal() += Vec3(-1.0, 1.0, 1.0);
  scaling.inverse_square /= eta2;
  scaling.l = scaling.W * z;
  return scaling;
}

}  // namespace tumble
