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
    switch (parameter_at(k)) {
      case calib::boresight_roll:
        c.roll.value = value;
        s.roll.value = known(s.roll.value);
        break;
      case calib::boresight_pitch:
        c.pitch.value = value;
        s.pitch.value = known(s.pitch.value);
        break;
      case calib::boresight_heading:
        c.heading.value = value;
        s.heading.value = known(s.heading.value);
        break;
      case calib::lever_forward:
      case calib::lever_right:
      case calib::lever_down:
        c.lever_arm_scanner[static_cast<size_t>(k - calib::lever_forward)].value = value;
        lever = std::max(lever, known(sensor.lever_arm.value));
        break;
      case calib::range_offset:
        c.range_offset.value = value;
        s.range_offset.value = known(s.range_offset.value);
        break;
      case calib::range_scale:
        c.range_scale = value;
        s.range_scale = known(s.range_scale);
        break;
      case calib::scan_offset:
        c.scan_offset.value = value;
        s.scan_offset.value = known(s.scan_offset.value);
        break;
      case calib::scan_scale:
        c.scan_scale = value;
        s.scan_scale = known(s.scan_scale);
        break;
      default:
        c.latency.value = value;
        s.latency.value = known(s.latency.value);
    }
  }
  s.lever_arm.value = lever;
  s.correlation = correlation_of(calib::delivered_covariance(a));
  return out;
}

}  // namespace swath::calib
