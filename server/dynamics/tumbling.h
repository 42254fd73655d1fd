// The generic free rotation of a body with three different moments: Jacobi's elliptic functions by theta series. Here the
// axes are sorted: 2 is the middle one, 3 the extreme one that the angular momentum circles; 1, 2, 3 is right-handed and
// w_3 >= 0. Followed is the rotation f that turns L, seen in these axes, onto z, and the axes about L from there.
// Source: Jacobi 1849; van Zon and Schofield 2007; Celledoni, Fasso, Saefstroem and Zanna 2008; the precession rate in
// Legendre's integrals, whose like-signed terms do not cancel.
#pragma once

#include <array>

#include "math/rotation.h"

namespace tumble {

class Tumbling {
 public:
  /// What the motion is made of; the names are those of the formulas in tumbling.cpp.
  struct Invariants {
    double A, C;                  ///< |L^2 - 2 T I_3| and |L^2 - 2 T I_1| (T: energy)
    double m, m1;                 ///< Parameter and 1 - m.
    double w_p;                   ///< Rate of the elliptic argument [rad/s], signed.
    std::array<double, 3> w_max;  ///< Amplitudes of w_1, w_2, w_3 [rad/s].
    double K, K1, excess;         ///< K(m), K(1-m), 1 - E/K.
    double u0;                    ///< Elliptic argument at the start.
    double F;                     ///< F(phi_v | 1-m), tan^2 phi_v = d23 I_1 / (d12 I_3).
    double E_v;                   ///< E(phi_v | 1-m)
    double precession;            ///< Mean rate about L, Omega [rad/s].
  };
  /// Sorted moments [kg m^2] and angular velocity [rad/s], |L| [kg m^2/s]. A > 0 and m > 0.
  static Invariants compute_invariants(const Vec3& I, const Vec3& w, double L);
  /// |L^2 - 2 T I_3| and |L^2 - 2 T I_1| from sums of like-signed terms. A = 0: a spin about axis 3.
  static double compute_A(const Vec3& I, const Vec3& w);
  static double compute_C(const Vec3& I, const Vec3& w);

  Tumbling() = default;
  Tumbling(const Vec3& I, const Vec3& w, double L);

  struct State {
    Quat f;      ///< Sorted axes to the frame whose z is along L.
    Vec3 L_hat;  ///< Direction of L in the sorted axes.
  };
  State at(double t) const;
  /// Largest rate of a phase [rad/s].
  double phase_rate() const;

 private:
  template <typename>
  friend struct Archived;  // its list of members, world/archive.cpp
  /// T: theta_1, 2, 3 of the phase z, along the components 2, 1, 3 of L. re + i im: theta_4(z + iy), whose phase, less
  /// `precessed`, is half the angle about L.
  struct Thetas {
    double T1, T2, T3, re, im;
    SinCos precessed;
  };
  void set_circular(const Invariants& c, const Vec3& l);
  void set_hyperbolic(const Invariants& c, const Vec3& l);
  Thetas circular(double z, double precessed) const;
  Thetas hyperbolic(double z, double precessed) const;

  static constexpr int kTerms = 5;
  using Coefficients = std::array<double, kTerms>;

  bool circular_ =
      true;  ///< m <= 1/2: series in the nome; else in the nome of 1 - m, after Jacobi's transform.
  int terms_ = 0;
  double z0_ = 0.0, z_rate_ = 0.0;  // [rad], [rad/s]
  double half_precession_ = 0.0;    // [rad/s]
  std::array<std::array<double, 4>, kTerms>
      series_{};                 ///< Term by term, of theta_3, im, theta_2 and theta_1,
  Coefficients re_{};            ///< and of re.
  double loss_ = 0.0, W_ = 0.0;  // circular: 1 - W, W
  double nome1_ = 0.0, K_ratio_ = 0.0, shift_ratio_ = 0.0;  // hyperbolic: nu_1, K/K', eta/K'
};

}  // namespace tumble
