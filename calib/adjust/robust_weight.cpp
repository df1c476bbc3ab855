// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the weights: Yang, "Robust estimation of geodetic datum transformation", Journal of Geodesy 73 (1999) 268 (three parts: full,
// reduced, none). Robust scale: 1.4826 times the median of absolute deviations.
#include "calib/adjust/robust_weight.h"

#include <cmath>

namespace swath::calib {

RobustWeight::RobustWeight(double full, double zero) : full_(full), zero_(zero), consistency_(1.0) {
  // Simpson's rule over 0 to `zero`; the density is symmetric.
  constexpr int steps = 2000;
  const double h = zero / steps;
  double sum = 0.0;
  for (int i = 0; i <= steps; ++i) {
    const double z = h * i;
    const double value = (*this)(z)*z * z * std::exp(-0.5 * z * z);
    sum += value * (i == 0 || i == steps ? 1.0 : i % 2 ? 4.0 : 2.0);
  }
  consistency_ = 2.0 * sum * h / 3.0 / std::sqrt(2.0 * 3.14159265358979323846);
}

}  // namespace swath::calib
