// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/geometry/geometry_control.h"

#include <cmath>
#include <map>

#include "calib/words.h"
#include "core/geo/geodesy.h"
#include "core/geo/undulation.h"
#include "core/statistics.h"

namespace swath::calib {
namespace {

constexpr double foot_length = 0.3048, like_feet = 0.03;  // of the ratio
// Geoids lie up to 107 m below and 86 m above the ellipsoid; where they are near to it the difference has other causes as well.
constexpr double highest_geoid = 110.0, lowest_geoid = 15.0;
constexpr double one_height = 0.5;  // m, and a hundredth of the difference: spread about it
constexpr double relief = 0.1;      // of the difference

double height_of(const SampledFlight& f, const Eigen::Vector3d& p) { return core::geodetic_of(f.frame.to_ecef(p)).height; }

}  // namespace

ControlFigures compare_control(const SampledFlight& f, const LineCells& cells, const Chain& chain, const trajectory::Trajectory& t) {
  ControlFigures out;
  out.points = f.plan.spots;
  out.near = f.plan.near_spots;
  out.nearest = f.plan.nearest_spot;
  std::map<size_t, const core::Shots*> shots;
  for (const PassSample& s : f.sample.surfaces) shots[s.pass] = &s.shots;
  const ShotGeometry geometry(chain.scanner, chain.calibration);
  const CalibrationCovariance C = calibration_covariance(f.sensor);
  trajectory::Cursor cursor(t);
  std::map<size_t, std::vector<double>> of_point;
  std::vector<double> variance;
  for (const ControlCell& c : cells.control) {
    of_point[c.point].push_back(c.apart);
    const auto look = look_at(*c.cell, *shots[cells.ground[c.ground].pass], height_direction(*c.cell), geometry, cursor, f.frame);
    if (!look) continue;
    const Variances v = variances(f.sensor, look->sigma);
    const Eigen::Matrix<double, 1, latency + 1> by = look->by.head<latency + 1>();
    double sum = look->own + c.sigma * c.sigma + by * C * by.transpose();
    for (int k = position_north; k <= attitude_heading; ++k) sum += v[static_cast<size_t>(k)] * look->by[k] * look->by[k];
    variance.push_back(sum);
  }
  std::vector<double> apart, ground, control;
  for (auto& [point, all] : of_point) {
    apart.push_back(core::median(std::move(all), 0.0));
    control.push_back(height_of(f, f.control[point].place));
    ground.push_back(control.back() + apart.back());
  }
  out.compared = apart.size();
  if (apart.empty()) return out;
  out.median = core::median(std::vector<double>(apart), 0.0);
  for (double& a : apart) a = std::abs(a - out.median);
  out.spread = core::mad_to_sigma * core::median(std::move(apart), 0.0);
  out.predicted = std::sqrt(core::median(std::move(variance), 0.0));
  out.ground = core::median(std::move(ground), 0.0);
  out.control = core::median(std::move(control), 0.0);
  return out;
}

std::optional<GeometryCheck> check_control(const ControlFigures& c, double ratio, double tolerance) {
  if (c.compared < fewest_control_points) return std::nullopt;
  const double off = std::abs(c.median);
  // Points scatter as well: roofs that are missed, trees that were cut.
  const double sigma = std::hypot(c.predicted, c.spread / std::sqrt(static_cast<double>(c.compared)));
  return GeometryCheck{"control_height", c.median, off <= tolerance || off <= ratio * sigma,
                       words("the ground lies %.2f m ", off) + (c.median > 0 ? "above" : "below") +
                           words(" the control (median of %.0f points, predicted %.2f m)", static_cast<double>(c.compared), c.predicted)};
}

std::optional<HeightMistake> height_mistake(const ControlFigures& c, double undulation, double range, bool control_over_geoid) {
  if (c.compared < fewest_control_points) return std::nullopt;
  const double size = std::abs(c.median);
  const bool known = std::isfinite(undulation), one = c.spread < one_height + 0.01 * size;
  const bool is_known = known && one && std::abs(size - std::abs(undulation)) < core::like_geoid && size > 2 * core::like_geoid;
  if (!is_known && size > 5) {
    const auto in_feet = [](double metres, double feet) { return feet != 0 && std::abs(metres / feet / foot_length - 1) < like_feet; };
    // Heights of control in feet are off by more where the ground is higher.
    if (c.spread < relief * size && in_feet(c.ground, c.control))
      return HeightMistake{"control_feet", "with the control's heights in feet",
                           "state the CRS of [[control]] with its height unit, or heights in metres"};
    // The ranges below a trajectory in feet are metres.
    if (one && in_feet(c.control + range, c.ground + range))
      return HeightMistake{"trajectory_height_feet", "with the trajectory's heights in feet",
                           "export the trajectory with heights in metres"};
  }
  if (!one || (known ? !is_known : size < lowest_geoid || size > highest_geoid)) return std::nullopt;
  // Heights above the geoid are less than those above the ellipsoid by the undulation.
  const bool of_trajectory = c.median * undulation < 0;
  if (known && of_trajectory && control_over_geoid)
    return HeightMistake{"height_geoid",
                         "with the control's heights ellipsoidal, or the trajectory's above the geoid" +
                             words(" (the geoid lies at %.0f m there)", undulation),
                         "where the control's heights are ellipsoidal, state its crs with +ellipsoidal; otherwise export the trajectory "
                         "with ellipsoidal heights"};
  const std::string whose = !known          ? "heights of trajectory or control"
                            : of_trajectory ? "the trajectory's heights"
                                            : "the control's heights";
  return HeightMistake{"height_geoid",
                       "with " + whose + " above the geoid in place of the ellipsoid" +
                           (known ? words(" (the geoid lies at %.0f m there)", undulation) : ""),
                       known && of_trajectory ? "export the trajectory with ellipsoidal heights"
                       : known                ? "state the CRS of [[control]] with its height system"
                               : "export the trajectory with ellipsoidal heights, state the CRS of [[control]] with its heights"};
}

}  // namespace swath::calib
