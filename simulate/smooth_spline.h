// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

namespace swath::simulate {

/// Splines of degree 5 (four continuous derivatives) with knots at even distances, fitted to samples by least squares; several channels
/// side by side. Gaps wider than a knot interval are bridged smoothly.
class SmoothSpline {
 public:
  static constexpr int channels = 6;
  using Row = Eigen::Matrix<double, 1, channels>;

  /// `time`: rising, s; one row of `values` per time. `spacing`: of the knots, s, above 0. At least two samples.
  SmoothSpline(const std::vector<double>& time, const std::vector<Row>& values, double spacing);

  struct At {
    Row value, rate, acceleration;
  };
  /// At an instant between the first and the last sample.
  At at(double t) const;

 private:
  /// Knot interval and place in it (0 to 1).
  int interval_of(double t, double& u) const;

  double begin_, spacing_;
  int intervals_;
  std::vector<Row> coefficients_;
};

}  // namespace swath::simulate
