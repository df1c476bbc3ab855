// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/target/roof_plane.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/statistics.h"

namespace swath::calib {

using Eigen::Vector2d;
using Eigen::Vector3d;

RoofPlane fit_roof_plane(const std::vector<Pierced>& pulses, const std::vector<Beamline>& beams, const RoofTarget& target,
                         const RoofMotion& m, double range_sigma) {
  constexpr double inset = 1.0;  // m, from the edges
  std::vector<Vector3d> rows;
  std::vector<double> heights;
  for (const Pierced& p : pulses) {
    if (beams[p.pulse].returns > 1) continue;
    const Vector2d at = p.place - m.at(p.place);
    bool within = true;
    for (size_t k = 0; k < target.sides() && within; ++k) {
      const RoofTarget::Side s = target.side(k);
      within = s.outward.dot(at - s.middle) < -inset;
    }
    if (!within || std::abs(p.first) > 2.0 * coarse_tolerance) continue;
    rows.push_back({1.0, m.x.dot(at - m.centre), m.y.dot(at - m.centre)});
    heights.push_back(p.first);
  }
  constexpr double residual_in_sigma = 3.5;
  RoofPlane fit;
  if (rows.size() < 10) return fit;
  fit.value[0] = core::median(heights);
  double cut = coarse_tolerance;
  constexpr int rounds = 6;
  constexpr double flat = 1e-6;  // of the tilts' prior: profiles determine one of them alone
  for (int i = 0; i < rounds; ++i) {
    Eigen::Matrix3d N = Eigen::Matrix3d::Zero();
    N(1, 1) = N(2, 2) = flat;
    Vector3d b = Vector3d::Zero();
    std::vector<double> size;
    for (size_t k = 0; k < rows.size(); ++k) {
      const double v = heights[k] - rows[k].dot(fit.value);
      if (std::abs(v) > cut) continue;
      N += rows[k] * rows[k].transpose();
      b += v * rows[k];
      size.push_back(std::abs(v));
    }
    if (size.size() < 10) return {};
    fit.value += N.ldlt().solve(b);
    double sum = 0.0;
    for (const double v : size) sum += v * v;
    fit.n = size.size();
    fit.rms = std::sqrt(sum / static_cast<double>(fit.n - 3));
    fit.sigma = fit.rms * N.inverse().diagonal().cwiseSqrt();
    cut = std::max(residual_in_sigma * core::mad_to_sigma * core::median(size), 2.0 * range_sigma);
  }
  return fit;
}

}  // namespace swath::calib
