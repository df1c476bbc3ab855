// SPDX-License-Identifier: GPL-3.0-or-later
// Weights for residuals with outliers among them, and the quantiles that tests need.
#pragma once

namespace swath::calib {

/// 1 up to `full`, then full / |z| ((zero - |z|) / (zero - full))^2, and 0 from `zero` on; z standardised.
class RobustWeight {
 public:
  RobustWeight(double full, double zero);
  double operator()(double z) const {
    const double a = z < 0.0 ? -z : z;
    if (a <= full_) return 1.0;
    if (!(a < zero_)) return 0.0;
    const double share = (zero_ - a) / (zero_ - full_);
    return full_ / a * share * share;
  }
  /// Mean of weight * z^2 for normally distributed z: divide sums of weight * z^2 by it.
  double consistency() const { return consistency_; }

 private:
  double full_, zero_, consistency_;
};

}  // namespace swath::calib
