// Elliptic integrals of real argument, parameter m = k^2, from + - * / and sqrt alone. Complete ones by the
// arithmetic-geometric mean, incomplete ones in Carlson's symmetric forms (DLMF 19.8, 19.36): both keep their relative
// accuracy up to the ends of the range, where the textbook phases and series cancel.
#pragma once

namespace tumble {

struct CompleteIntegrals {
  double K;       ///< K(m)
  double excess;  ///< 1 - E(m)/K(m), accurate also where E is nearly K
};

/// From m and m1 = 1 - m, given apart so that neither cancels; 0 <= m <= 1, 1e-280 <= m1 <= 1.
CompleteIntegrals compute_complete_integrals(double m, double m1);

struct CarlsonIntegrals {
  double R_F, R_D;
};

/// R_F(x, y, 1) and R_D(x, y, 1) for x, y >= 0, at most one of them 0; relative error 5e-16.
CarlsonIntegrals compute_carlson_integrals(double x, double y);

}  // namespace tumble
