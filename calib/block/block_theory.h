// SPDX-License-Identifier: GPL-3.0-or-later
// Accuracy of a block before it is flown: the points' standard deviations of a regular block with stations, by full covariance of its
// bundle adjustment (Ackermann, figures 8-10, Quadro 1), and backwards the station sigma that a tolerance allows (Quadro 2).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calib/block/image_block.h"
#include "core/config/option.h"
#include "core/config/result.h"

namespace swath::calib {

/// a: four corners with chains of heights across both ends; b: four corners alone.
enum class ControlLayout { none, corners, chains };

struct TheoryCase {
  std::string name;
  DriftSets drift = DriftSets::none;
  ControlLayout control = ControlLayout::chains;
  int cross_strips = 0;
};

template <class V>
void describe(TheoryCase& c, V& v) {
  v.option("name", c.name, "Name of the case, for the table.");
  v.option("drift", c.drift, "Unknown shift and drift of the stations: none, one set for the block, or one per strip.", "Ackermann, eq 1");
  v.option("control", c.control, "Ground control: none, four corners, or corners with chains of heights across both ends.");
  v.option("cross_strips", c.cross_strips, core::within(0, 20),
           "Strips across the others, the outer two over the second and last but one images.");
}

/// What is asked of a block: tolerances at a map scale, flown at a scale of photographs.
struct TheoryDemand {
  std::string map;
  double scale = 30000.0;
  std::optional<core::Metres> mu_xy, mu_z;
};

template <class V>
void describe(TheoryDemand& d, V& v) {
  v.option("map", d.map, "Name, usually the scale of the map.");
  v.option("scale", d.scale, core::above(1.0), "Scale number of the images.");
  v.option("mu_xy", d.mu_xy, core::above(0), "Largest standard deviation in x and y, root mean square over the points.");
  v.option("mu_z", d.mu_z, core::above(0), "Largest standard deviation of heights.");
}

struct TheoryOptions {
  double scale = 30000.0;
  core::Metres focal_length{0.15}, format{0.23}, usable{0.228};
  double forward = 0.6, side = 0.2;
  int strips = 6, images = 21;
  core::Metres sigma_image{10e-6};
  std::optional<core::Metres> sigma_station, sigma_control;
  core::MetresPerSecond speed{70.0};
  core::Seconds turn{180.0};
  std::vector<TheoryCase> cases;
  std::vector<TheoryDemand> demands;

  /// The unit of results, sigma0 s, m.
  double unit() const { return sigma_image.value * scale; }
};

template <class V>
void describe(TheoryOptions& o, V& v) {
  v.option("scale", o.scale, core::above(1.0), "Scale number of the images.");
  v.option("focal_length", o.focal_length, core::above(0), "Principal distance.");
  v.option("format", o.format, core::above(0), "Side of the square image, for overlaps.");
  v.option("usable", o.usable, core::above(0), "Side of the part where points are measured.");
  v.option("forward", o.forward, core::within(0.5, 0.95), "Overlap along a strip.");
  v.option("side", o.side, core::within(0.05, 0.9), "Overlap of neighbouring strips.");
  v.option("strips", o.strips, core::within(1, 200), "Strips.");
  v.option("images", o.images, core::within(3, 1000), "Images of a strip.");
  v.option("sigma_image", o.sigma_image, core::above(0), "Sigma of an image coordinate, sigma0.");
  v.option("sigma_station", o.sigma_station, core::above(0), "Sigma of a station's coordinate; default: sigma_image times scale.");
  v.option("sigma_control", o.sigma_control, core::above(0), "Sigma of a control coordinate; default: sigma_image times scale.");
  v.option("speed", o.speed, core::above(0), "Ground speed, for the times of drifts.");
  v.option("turn", o.turn, core::at_least(0), "Time between two strips, beside that of one base.");
  v.tables("case", o.cases, "Cases of the table; default: those of Ackermann's Quadro 1.");
  v.tables("demand", o.demands, "Tolerances to find the station sigma for; default: those of Ackermann's Quadro 2.");
}

/// Accuracy of one case.
struct TheoryFound {
  std::string name;
  size_t images = 0, points = 0, rays = 0;
  double unit = 0.0;                                       ///< m
  double mu_x = 0.0, mu_y = 0.0, mu_xy = 0.0, mu_z = 0.0;  ///< m, root mean square over all points
  double max_xy = 0.0, max_z = 0.0;                        ///< m
  double station = 0.0;                                    ///< m, sigma of stations
  std::string refused;                                     ///< why the case has no solution
};

template <class V>
void describe(const TheoryFound& r, V& v) {
  const bool solved = r.refused.empty();
  const auto in_units = [&](double x) { return x / r.unit; };
  v.result("case", r.name, "Name.");
  v.result("images", r.images, "Images.");
  v.result("points", r.points, "Points with two rays or more.");
  v.result("image_points", r.rays, "Rays.");
  v.result("mu_xy_m", r.mu_xy, core::metres(3).only_if(solved), "Standard deviation in x and y: root of the mean variance of all points.");
  v.result("mu_z_m", r.mu_z, core::metres(3).only_if(solved), "The same of heights.");
  v.result("mu_xy", in_units(r.mu_xy), core::plain(3).only_if(solved), "mu_xy_m in units of sigma0 times the scale.");
  v.result("mu_z", in_units(r.mu_z), core::plain(3).only_if(solved), "mu_z_m in that unit.");
  v.result("mu_x", in_units(r.mu_x), core::plain(3).only_if(solved), "Along the strips.");
  v.result("mu_y", in_units(r.mu_y), core::plain(3).only_if(solved), "Across them.");
  v.result("max_xy", in_units(r.max_xy), core::plain(3).only_if(solved), "Of the worst point, root mean square of x and y.");
  v.result("max_z", in_units(r.max_z), core::plain(3).only_if(solved), "Of the worst point.");
  v.result("refused", r.refused, core::plain().only_if(!solved), "What is not determined.");
}

/// The station sigma that keeps a tolerance.
struct AllowedFound {
  std::string map, name;
  double scale = 0.0;
  std::optional<double> for_xy, for_z;  ///< m; without a value: no station sigma is too large, or none small enough
  bool xy_unreachable = false, z_unreachable = false;
};

template <class V>
void describe(const AllowedFound& r, V& v) {
  v.result("map", r.map, "Name of the demand.");
  v.result("scale", r.scale, core::plain(0), "Scale number of the images.");
  v.result("case", r.name, "Name of the case.");
  v.result("sigma_station_for_xy_m", r.for_xy, core::metres(3), "Largest sigma of stations that keeps mu_xy; left out: there is no limit.");
  v.result("sigma_station_for_z_m", r.for_z, core::metres(3), "Largest sigma of stations that keeps mu_z.");
  v.result("xy_not_reached", r.xy_unreachable, "mu_xy is missed whatever the stations.");
  v.result("z_not_reached", r.z_unreachable, "mu_z is missed whatever the stations.");
}

struct TheoryTable {
  std::vector<TheoryFound> cases;
  std::vector<AllowedFound> allowed;
};
template <class V>
void describe(const TheoryTable& t, V& v) {
  v.tables("cases", t.cases, "Accuracy by case.");
  v.tables("allowed", t.allowed, "Largest station sigmas by demand and case.");
}

/// The block of a case at true values: rays where a point falls on the usable part of an image.
ImageBlock theoretical_block(const TheoryOptions& options, const TheoryCase& which);
TheoryFound theory_of(const TheoryOptions& options, const TheoryCase& which);
/// Cases and demands of the options, or Ackermann's.
TheoryTable theory_table(TheoryOptions options);
std::string theory_text(const TheoryTable& table);

}  // namespace swath::calib

namespace swath::core {
template <>
struct Choices<calib::ControlLayout> {
  static constexpr std::array<std::string_view, 3> names{"none", "corners", "chains"};
};
}  // namespace swath::core
