// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/flight/place.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "core/geo/geodesy.h"
#include "core/geo/map_scale.h"
#include "core/records/gnss_data.h"
#include "core/statistics.h"
#include "stages/area.h"

namespace swath::stages {
namespace {

constexpr double margin = 3.0;  // degrees: half a UTM zone, beyond which its scale error passes 0.3 %

/// How far a place (rad) lies outside the area of use of the run's CRS, degrees.
double beside_area(const Context& context, double latitude, double longitude) {
  return core::degrees_outside(context.crs, {core::to_degrees(longitude), core::to_degrees(latitude)});
}

[[noreturn]] void refuse(const Context& context, const char* what, double beside, const char* hint) {
  throw core::usage_error(std::string(what) + " " + core::format_number(std::round(beside * 10) / 10) +
                              " degrees outside the area of use of " + context.crs.name(),
                          context.survey.crs, hint);
}

void check_area(const Context& context, const core::TrajectoryData& d, core::Tally& tally) {
  std::uint64_t outside = 0;
  for (size_t i = 0; i < d.size(); ++i) {
    const double beside = beside_area(context, d.latitude[i], d.longitude[i]);
    if (beside > margin)
      refuse(context, "the trajectory lies", beside,
             "choose the CRS of the survey's place; is the trajectory in degrees where radians are meant?");
    outside += beside > 0;
  }
  if (outside) tally.count("trajectory records outside the CRS's area of use (" + context.crs.name() + ")", outside);
}

}  // namespace

Eigen::Vector3d origin_near(const Context& context, const Eigen::Vector3d& position) {
  const auto to_kilometres = [](double metres) { return std::round(metres / 1000.0) * 1000.0; };
  return {to_kilometres(position.x() * context.unit), to_kilometres(position.y() * context.unit), 0.0};
}

void check_place_of_fixes(const Context& context, const core::GnssData& fixes) {
  if (context.crs.empty() || !context.crs.is_projected()) return;
  std::vector<double> beside;
  for (const Eigen::Vector3d& p : fixes.position) {
    const core::Geodetic g = core::geodetic_of(p);
    beside.push_back(beside_area(context, g.latitude, g.longitude));
  }
  if (const double median = core::median(std::move(beside), 0.0); median > margin)
    refuse(
        context, "the GNSS fixes lie", median,
        "choose the CRS of the survey's place; are columns swapped (latitude and longitude, x and y), or has a longitude lost its sign?");
}

void place_on_map(Context& context, const trajectory::Trajectory& trajectory, core::Tally& tally) {
  if (context.crs.empty() || !context.crs.is_projected()) return;
  const core::TrajectoryData& d = trajectory.data();
  const core::Transform to_map(core::wgs84_geodetic(), context.crs);
  context.origin = origin_near(context, to_map({core::to_degrees(d.longitude[0]), core::to_degrees(d.latitude[0]), d.height[0]}));
  check_area(context, d, tally);
  // Some records are enough: the margin is far wider.
  const size_t step = std::max<size_t>(1, d.size() / 100000);
  std::vector<double> x, y, z;
  for (size_t i = 0; i < d.size(); i += step) {
    x.push_back(core::to_degrees(d.longitude[i]));
    y.push_back(core::to_degrees(d.latitude[i]));
    z.push_back(d.height[i]);
  }
  to_map.apply(x.data(), y.data(), z.data(), x.size());
  Box places{Area::none, Area::none, -Area::none, -Area::none};
  for (size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i] + y[i])) continue;
    const double east = x[i] * context.unit, north = y[i] * context.unit;
    places = {std::min(places.x0, east), std::min(places.y0, north), std::max(places.x1, east), std::max(places.y1, north)};
  }
  if (places.x0 <= places.x1) set_area(context, places, around_trajectory);
}

}  // namespace swath::stages
