// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/delivered.h"

#include <algorithm>
#include <cmath>

#include "calib/report/verdict.h"

namespace swath::calib {
namespace {

/// Row by row.
std::vector<double> correlation_of(const Eigen::MatrixXd& covariance) {
  std::vector<double> out;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i)
    for (Eigen::Index j = 0; j < covariance.cols(); ++j) {
      const double scale = std::sqrt(std::max(0.0, covariance(i, i)) * std::max(0.0, covariance(j, j)));
      out.push_back(i == j ? 1.0 : scale > 0.0 ? std::clamp(covariance(i, j) / scale, -1.0, 1.0) : 0.0);
    }
  return out;
}

}  // namespace

DeliveredCalibration delivered(const calib::Adjustment& a, const core::SensorSigma& sensor) {
  DeliveredCalibration out{a.calibration, sensor};
  core::Calibration& c = out.calibration;
  core::SensorSigma& s = out.sigma;
  double lever = 0.0;
  for (int k = 0; k < estimated_count; ++k) {
    const calib::Estimate& e = a.estimates[static_cast<size_t>(k)];
    const bool good = is_delivered(a, parameter_at(k));
    if (!e.estimated) {
      if (k >= calib::lever_forward && k <= calib::lever_down) lever = std::max(lever, sensor.lever_arm.value);
      continue;
    }
    const double value = good ? e.value : e.start;
    // A start value that was to be estimated and could not: it is known as well as was stated for it.
    const auto known = [&](double stated) {
      return good                       ? e.sigma
             : std::isfinite(e.apriori) ? std::max(e.apriori, stated)
                                        : std::max(stated, std::hypot(e.found - e.start, e.found_sigma));
    };
    const auto give = [&](double& to, double& its_sigma) { to = value, its_sigma = known(its_sigma); };
    switch (parameter_at(k)) {
      case calib::boresight_roll:
        give(c.roll.value, s.roll.value);
        break;
      case calib::boresight_pitch:
        give(c.pitch.value, s.pitch.value);
        break;
      case calib::boresight_heading:
        give(c.heading.value, s.heading.value);
        break;
      case calib::lever_forward:
      case calib::lever_right:
      case calib::lever_down:
        c.lever_arm_scanner[static_cast<size_t>(k - calib::lever_forward)].value = value;
        lever = std::max(lever, known(sensor.lever_arm.value));
        break;
      case calib::range_offset:
        give(c.range_offset.value, s.range_offset.value);
        break;
      case calib::range_scale:
        give(c.range_scale, s.range_scale);
        break;
      case calib::scan_offset:
        give(c.scan_offset.value, s.scan_offset.value);
        break;
      case calib::scan_scale:
        give(c.scan_scale, s.scan_scale);
        break;
      default:
        give(c.latency.value, s.latency.value);
    }
  }
  s.lever_arm.value = lever;
  s.correlation = correlation_of(calib::delivered_covariance(a));
  return out;
}

}  // namespace swath::calib
