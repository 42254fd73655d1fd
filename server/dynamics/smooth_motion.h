// Bodies on which only smooth forces act, none of them constant: springs, pushes that turn with the body, damping. One
// step of Gauss collocation of order 6 (Hairer, Lubich and Wanner 2006, II.1): for the oscillator it keeps the energy, its
// phase error falls with the sixth power of the step. World frame; the momentum is the state of rotation.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "dynamics/body.h"
#include "dynamics/force_spring.h"
#include "dynamics/load.h"

namespace tumble {

struct SmoothBody {
  BodyType type = BodyType::fixed;
  MassProperties mass;
  Motion motion;  ///< In: at the start. Out: at the end (dynamic bodies).
  Load load;
  Vec3 gravity = Vec3::Zero();                         ///< [m/s^2]
  double linear_damping = 0.0, angular_damping = 0.0;  ///< [1/s]
};

/// Between points of two bodies, from their centres of mass in body axes [m].
struct SmoothSpring {
  std::uint32_t a = 0, b = 0;
  Vec3 pA = Vec3::Zero(), pB = Vec3::Zero();
  Spring spring;
};

struct SmoothSystem {
  std::vector<SmoothBody> bodies;
  std::vector<SmoothSpring> springs;

  /// Rates of change of a body's state.
  struct Slope {
    Vec3 x = Vec3::Zero(), v = Vec3::Zero(), L = Vec3::Zero();
    Eigen::Vector4d q = Eigen::Vector4d::Zero();
  };
  /// Where a body is at a stage; w and the matrix are what the springs need of it.
  struct Place {
    Vec3 x, v, w, L;
    Eigen::Vector4d q;
    Mat3 R_WB;
  };
  static constexpr std::size_t kStages = 3;
  /// What advance_smoothly writes on; kept, so that it allocates nothing but for a larger system.
  struct Scratch {
    std::array<std::vector<Slope>, kStages> slopes;
    std::vector<Place> places;
    std::vector<Vec3> forces, torques;
    std::vector<Motion> start;
  } scratch;
};

/// Moves the dynamic bodies through h [s], in sub-steps of 0.05 rad of the fastest turn and 0.1 rad of the stiffest
/// spring. False, and nothing is moved, if that would take more than 32 of them or the stages do not converge: the
/// caller has an implicit rule for springs that stiff.
bool advance_smoothly(SmoothSystem& system, double h);

}  // namespace tumble
