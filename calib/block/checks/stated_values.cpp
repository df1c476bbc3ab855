// SPDX-License-Identifier: GPL-3.0-or-later
// An observed value l with sigma s and the adjusted one x differ by a standard deviation of sqrt(s^2 - sigma_x^2).
#include "calib/block/checks/stated_values.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/config/units.h"
#include "core/geo/frames.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;

struct StatedValue {
  std::string name;
  double value = 0.0, sigma = 0.0;  ///< in the unit of CameraValueFound
  double from = 0.0, factor = 1.0;  ///< what it is of the adjusted one: from + factor x
};

/// In the order of CameraFound::values.
std::vector<StatedValue> stated_values(const BlockCamera& c, const CameraConfig& config, const CameraFound& found) {
  std::vector<StatedValue> out;
  for (int k = 0; k < camera_values; ++k) out.push_back({found.values[out.size()].name, c.value[k], c.sigma[k]});
  const core::Attitude turned = core::attitude_of(c.body_R_camera * camera_mounting(config.mount, {}).transpose());
  for (const double angle : {turned.roll, turned.pitch, core::wrap_pi(turned.heading)})
    out.push_back({found.values[out.size()].name, angle / core::degree, c.boresight_sigma.minCoeff() / core::degree});
  const Vector3d arm = c.body_R_camera * c.antenna;
  static constexpr std::array<const char*, 3> axes{"forward", "right", "down"};
  for (size_t k = 0; k < 3; ++k) {
    StatedValue v{found.values[out.size()].name, arm[static_cast<Eigen::Index>(k)], c.antenna_sigma.minCoeff()};
    if (config.of_survey) {  // the adjusted antenna is the stated lever arm less the true one
      const double lever = config.of_survey->lever_arm[k].value;
      v = {std::string("lever_arm ") + axes[k], lever - v.value, v.sigma, lever, -1.0};
    }
    out.push_back(v);
  }
  return out;
}

std::string sentence(const std::string& camera, const StatedValue& v, double adjusted, const std::string& unit, bool by_sign) {
  char text[240];
  std::snprintf(text, sizeof text, "%s of camera %s is %.5g%s%s after the adjustment, and %.5g with a sigma of %.2g as stated; %s",
                v.name.c_str(), camera.c_str(), adjusted, unit.empty() ? "" : " ", unit.c_str(), v.value, v.sigma,
                by_sign ? "the opposite sign explains it" : "check the value, its sign and its sigma");
  return text;
}

}  // namespace

std::vector<std::string> stated_value_findings(const ReadBlock& stated, const BlockConfig& config, const BlockFound& found) {
  constexpr double differs = 4.0, least = 0.1;  // standard deviations; of the sigma where the block says next to nothing
  std::vector<std::string> out;
  for (size_t c = 0; c < found.cameras.size(); ++c) {
    const std::vector<StatedValue> values = stated_values(stated.block.cameras[c], config.cameras[c], found.cameras[c]);
    for (size_t k = 0; k < values.size(); ++k) {
      const CameraValueFound& f = found.cameras[c].values[k];
      const StatedValue& v = values[k];
      if (f.held || !(v.sigma > 0.0) || !std::isfinite(v.sigma)) continue;
      const double adjusted = v.from + v.factor * f.value, difference = std::abs(adjusted - v.value),
                   own = std::max(least * v.sigma, std::sqrt(std::max(0.0, v.sigma * v.sigma - f.sigma * f.sigma)));
      if (difference > differs * own)
        out.push_back(sentence(found.cameras[c].name, v, adjusted, f.unit, std::abs(adjusted + v.value) < difference / 3.0));
    }
  }
  return out;
}

}  // namespace swath::calib
