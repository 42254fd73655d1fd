// One free body in another engine, for comparisons: Bullet and ODE, both in double precision, with their gyroscopic terms.
#pragma once

#include <memory>

#include "dynamics/body.h"

namespace tumble::bench {

/// `count` bodies of 1 kg far apart that start alike, each with its own position.
class FreeBodies {
 public:
  virtual ~FreeBodies() = default;
  virtual void step(double h) = 0;
  virtual Motion motion() const = 0;  ///< Of the first: x, q, v, w.
};

std::unique_ptr<FreeBodies> make_bullet(int count, const Vec3& I, const Vec3& w, const Vec3& v,
                                        const Vec3& gravity);
std::unique_ptr<FreeBodies> make_ode(int count, const Vec3& I, const Vec3& w, const Vec3& v,
                                     const Vec3& gravity);

}  // namespace tumble::bench
