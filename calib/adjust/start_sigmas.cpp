// SPDX-License-Identifier: GPL-3.0-or-later
// The test of a start value is that of an innovation: what was found departs from the start by a variance of apriori^2 - formal^2.
#include "calib/adjust/start_sigmas.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace swath::calib {
namespace {

// Of a departure's sigma: one in 16 000 start values that are as uncertain as stated is taken for contradicted.
constexpr double too_far = 4.0;
// Share of the knowledge that the flight must bring to contradict anything.
constexpr double least_share = 0.5;

}  // namespace

double apriori_of(const AprioriOptions& o, Parameter p) {
  const double sigma[] = {o.roll.value,         o.pitch.value, o.heading.value,     o.lever_arm.value, o.lever_arm.value, o.lever_arm.value,
                          o.range_offset.value, o.range_scale, o.scan_offset.value, o.scan_scale,      o.latency.value};
  return sigma[p] > 0.0 ? sigma[p] : std::numeric_limits<double>::infinity();
}

AprioriOptions start_sigmas(const core::SensorSigma& s) {
  AprioriOptions out;
  const auto take = [&](const char* key, double stated, double& into) {
    if (stated > 0.0 && std::find(s.stated.begin(), s.stated.end(), key) != s.stated.end()) into = stated;
  };
  take("roll", s.roll.value, out.roll.value);
  take("pitch", s.pitch.value, out.pitch.value);
  take("heading", s.heading.value, out.heading.value);
  take("lever_arm", s.lever_arm.value, out.lever_arm.value);
  take("range_offset", s.range_offset.value, out.range_offset.value);
  take("range_scale", s.range_scale, out.range_scale);
  take("scan_offset", s.scan_offset.value, out.scan_offset.value);
  take("scan_scale", s.scan_scale, out.scan_scale);
  take("latency", s.latency.value, out.latency.value);
  return out;
}

Eigen::VectorXd contradicted(const Eigen::VectorXd& found, const Eigen::VectorXd& formal, const Eigen::VectorXd& apriori) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(found.size());
  for (Eigen::Index i = 0; i < found.size(); ++i) {
    if (!std::isfinite(apriori[i])) continue;
    const double variance = apriori[i] * apriori[i] - formal[i] * formal[i];
    if (variance < least_share * apriori[i] * apriori[i]) continue;
    const double t = std::abs(found[i]) / std::sqrt(variance);
    if (t > too_far) out[i] = t;
  }
  return out;
}

}  // namespace swath::calib
