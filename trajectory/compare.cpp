// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/compare.h"

#include <algorithm>
#include <cmath>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"

namespace swath::trajectory {

core::TrajectoryErrors errors_against(const core::TrajectoryData& t, const Trajectory& truth) {
  core::TrajectoryErrors out;
  Cursor cursor(truth);
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (!cursor.seek(t.time[i])) {
      ++out.outside;
      continue;
    }
    const Pose pose = cursor.pose(t.time[i]);
    const core::Geodetic place = core::geodetic_of(pose.position);
    const Eigen::Matrix3d ned_R_ecef = core::ecef_R_ned(place.latitude, place.longitude).transpose();
    const core::Attitude attitude = core::attitude_of(ned_R_ecef * pose.ecef_R_body);
    out.time.push_back(t.time[i]);
    out.position.push_back(ned_R_ecef * (core::ecef_of({t.latitude[i], t.longitude[i], t.height[i]}) - pose.position));
    out.attitude.emplace_back(core::wrap_pi(t.roll[i] - attitude.roll), core::wrap_pi(t.pitch[i] - attitude.pitch),
                              core::wrap_pi(t.heading[i] - attitude.heading));
    if (!t.has_sigma()) continue;
    out.position_sigma.emplace_back(t.sigma_north[i], t.sigma_east[i], t.sigma_down[i]);
    out.attitude_sigma.emplace_back(t.sigma_roll[i], t.sigma_pitch[i], t.sigma_heading[i]);
  }
  return out;
}

Comparison compare(const core::TrajectoryErrors& errors, const std::vector<Span>& within) {
  Comparison out;
  const bool has_sigma = !errors.position_sigma.empty();
  std::array<double, 6> sum{}, square{}, ratio{}, with_sigma{};
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const auto holds = [t = errors.time[i]](const Span& s) { return t >= s.first && t <= s.last; };
    if (!within.empty() && std::none_of(within.begin(), within.end(), holds)) continue;
    ++out.compared;
    for (std::size_t c = 0; c < 6; ++c) {
      const auto axis = static_cast<Eigen::Index>(c % 3);
      const double e = (c < 3 ? errors.position : errors.attitude)[i][axis];
      sum[c] += e;
      square[c] += e * e;
      out.component[c].largest = std::max(out.component[c].largest, std::abs(e));
      if (!has_sigma) continue;
      const double sigma = (c < 3 ? errors.position_sigma : errors.attitude_sigma)[i][axis];
      if (!(sigma > 0.0)) continue;
      ratio[c] += e * e / (sigma * sigma);
      ++with_sigma[c];
    }
  }
  if (out.compared == 0) return out;
  const auto n = static_cast<double>(out.compared);
  for (std::size_t c = 0; c < 6; ++c) {
    out.component[c].mean = sum[c] / n;
    out.component[c].rms = std::sqrt(square[c] / n);
    if (with_sigma[c] > 0.0) out.component[c].over_sigma = std::sqrt(ratio[c] / with_sigma[c]);
  }
  return out;
}

}  // namespace swath::trajectory
