// SPDX-License-Identifier: GPL-3.0-or-later
// What is asked of a flight: the one declaration of each option of `swath plan`.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/records/sensor.h"
#include "planning/error_budget.h"
#include "planning/scan_pattern.h"

namespace swath::planning {

struct SensorOptions {
  ScanPattern pattern = ScanPattern::triangle;
  std::optional<core::Hertz> prf, frequency;
  std::optional<core::Radians> half_angle;
  core::Radians divergence{0.3e-3};
  std::optional<core::Joules> pulse_energy;
  core::Metres wavelength{1064e-9};
  std::optional<core::Metres> max_range;
  bool multiple_pulses = false;
};

template <class V>
void describe(SensorOptions& s, V& v) {
  v.option("pattern", s.pattern, "Motion of the beam: oscillating mirror (triangle, sine) or one-way polygon.");
  v.option("prf", s.prf, core::within(10, 1e7), "Pulses per second; must be given.");
  v.option("frequency", s.frequency, core::within(0.1, 5000), "Full scans (there and back; polygon: facets) per second; must be given.");
  v.option("half_angle", s.half_angle, core::within(0.005, 1.2), "Half of the field of view; must be given.");
  v.option("divergence", s.divergence, core::above_to(0, 0.01), "Full divergence of the beam (1/e2).", "Brandalize (1)");
  v.option("pulse_energy", s.pulse_energy, core::above_to(0, 1), "Energy of one pulse; without it eye safety is not judged.",
           "IEC 60825-1");
  v.option("wavelength", s.wavelength, core::within(400e-9, 2600e-9), "Of the laser.", "IEC 60825-1");
  v.option("max_range", s.max_range, core::above_to(0, 1e4), "Longest range to dark ground, from the data sheet.");
  v.option("multiple_pulses", s.multiple_pulses, "The sensor distinguishes several pulses that are in the air at a time.");
  v.check(s.prf.has_value(), "the pulse rate must be given: prf = \"100 kHz\"");
  v.check(s.frequency.has_value(), "the scan rate must be given: frequency = \"50 Hz\"");
  v.check(s.half_angle.has_value(), "half of the field of view must be given: half_angle = \"20 deg\"");
}

enum class PlanPattern {
  block,        ///< parallel lines over the area, and lines across them
  calibration,  ///< over the middle of the area in many ways (calibration_flight.h)
};

struct FlightOptions {
  PlanPattern pattern = PlanPattern::block;
  std::optional<core::Metres> height, second_height, spacing;
  std::optional<double> density;
  std::optional<core::MetresPerSecond> speed;
  double overlap = 0.3;
  std::optional<core::Radians> direction;
  int cross_lines = 0;
  bool terrain_following = false;
  core::Metres level_step{10.0}, margin{0.0}, clearance{50.0};
  core::Radians bank = core::degrees(22.0);
  core::Seconds lead{5.0};
  core::MetresPerSecond climb_rate{3.0};
};

template <class V>
void describe(FlightOptions& f, V& v) {
  v.option("pattern", f.pattern, "block: parallel lines; calibration: over the area's middle in many ways.");
  v.option("height", f.height, core::within(10, 1e4), "Above the mean ground: of the area, or of each line with `terrain_following`.");
  v.option("second_height", f.second_height, core::within(10, 1e4), "Second height of a calibration flight; default: 11/7 of the first.");
  v.option("density", f.density, core::within(0.001, 1e4), "In place of a height: pulses per m2 of one swath over the lowest ground.",
           "Brandalize (4)");
  v.option("speed", f.speed, core::within(1, 150), "Ground speed; must be given.");
  v.option("overlap", f.overlap, core::within(0, 0.9), "Least share of the swath that neighbouring lines have in common, anywhere.");
  v.option("spacing", f.spacing, core::above_to(0, 1e4), "Distance of the lines, in place of an overlap.");
  v.option("direction", f.direction, core::within(0, 2 * core::pi), "Of the lines, clockwise from grid north; default: the fewest lines.");
  v.option("cross_lines", f.cross_lines, core::within(0, 50), "Lines flown across the others.");
  v.option("terrain_following", f.terrain_following, "Each line has a height of its own above the ground below it.");
  v.option("level_step", f.level_step, core::within(0.1, 500), "Heights of such lines are whole multiples of it.");
  v.option("margin", f.margin, core::within(0, 5000), "Flown beyond the area's edge, on all sides.");
  v.option("clearance", f.clearance, core::within(0, 5000), "Least height above the ground that may be flown.");
  v.option("bank", f.bank, core::within(0.05, 1.0), "Bank of turns between lines.");
  v.option("lead", f.lead, core::within(0, 300), "Straight flight before and after each line.");
  v.option("climb_rate", f.climb_rate, core::within(0.1, 50), "Between lines of different heights.");
  v.check(f.height.has_value() != f.density.has_value(), "one of `height` and `density` must be given, not both");
  v.check(f.pattern == PlanPattern::block || f.height, "a calibration flight wants a height, not a density");
  v.check(f.speed.has_value(), "the ground speed must be given: speed = \"50 m/s\"");
}

struct BaseOptions {
  std::string name;
  core::Metres east, north;
};

template <class V>
void describe(BaseOptions& b, V& v) {
  v.option("name", b.name, "Name of the base station.");
  v.option("east", b.east, "Easting.");
  v.option("north", b.north, "Northing.");
}

struct CornerOptions {
  core::Metres east, north;
};

template <class V>
void describe(CornerOptions& c, V& v) {
  v.option("east", c.east, "Easting.");
  v.option("north", c.north, "Northing.");
}

struct CostOptions {
  std::string currency = "EUR";
  double fixed = 0.0, per_hour = 0.0, per_line = 0.0, per_sortie = 0.0;
  core::Seconds transit, endurance{4 * 3600.0};
};

template <class V>
void describe(CostOptions& c, V& v) {
  v.option("currency", c.currency, "Name of the currency.");
  v.option("fixed", c.fixed, core::within(0, 1e9), "Whatever the flight: mobilisation, permissions.");
  v.option("per_hour", c.per_hour, core::within(0, 1e7), "For each hour of flight, transit included.");
  v.option("per_line", c.per_line, core::within(0, 1e7), "For each line.");
  v.option("per_sortie", c.per_sortie, core::within(0, 1e7), "For each sortie.");
  v.option("transit", c.transit, core::within(0, 86400), "To the area and back, in each sortie.");
  v.option("endurance", c.endurance, core::within(60, 86400), "Longest sortie, transit included.");
}

inline void describe(TrajectorySigma& s, core::Visitor& v) {
  v.option("horizontal", s.horizontal, core::at_least(0), "Sigma of the trajectory's position, north and east each.");
  v.option("vertical", s.vertical, core::at_least(0), "Sigma of its height.");
  v.option("roll_pitch", s.roll_pitch, core::at_least(0), "Sigma of roll and pitch.");
  v.option("heading", s.heading, core::at_least(0), "Sigma of the heading.");
}

struct PlanOptions {
  std::string name = "plan", crs;
  std::filesystem::path area, dem;
  std::vector<CornerOptions> corners;
  std::optional<core::Metres> ground, cell;
  double penetration = 1.0;
  SensorOptions sensor;
  FlightOptions flight;
  core::SensorSigma sigma;
  TrajectorySigma trajectory_sigma;
  std::vector<BaseOptions> bases;
  CostOptions cost;
};

template <class V>
void describe(PlanOptions& o, V& v) {
  v.option("name", o.name, "Name of the plan.");
  v.option("crs", o.crs, "Projected CRS of the plan; default: that of the terrain model, else of the area.");
  v.option("area", o.area, "Polygons to be flown: GeoPackage, GeoJSON, DXF ..., relative to this file.");
  v.tables("corner", o.corners, "Corners of the area, in their order, in place of a file.");
  v.option("dem", o.dem, "Terrain model, relative to this file; --dem comes before it.");
  v.option("ground", o.ground, core::within(-500, 9000), "Height of level ground, in place of a terrain model.");
  v.option("cell", o.cell, core::above_to(0, 1e4), "Side of the cells of density and accuracy; default: 1/40 of a swath.");
  v.option("penetration", o.penetration, core::above_to(0, 1), "Share of the pulses that reach the ground.", "Brandalize 5.3");
  v.table("sensor", o.sensor, "Scanner.");
  v.table("flight", o.flight, "Flight.");
  v.table("sigma", o.sigma, "Sigmas of the sensor, as in survey.toml.");
  v.table("trajectory_sigma", o.trajectory_sigma, "Sigmas of the trajectory to be expected.");
  v.tables("base", o.bases, "GNSS base stations.");
  v.table("cost", o.cost, "Cost.");
  v.check(o.area.empty() != o.corners.empty(), "the area must be given, by `area` (a file) or by [[corner]]");
  v.check(o.corners.empty() || o.corners.size() >= 3, "an area has at least three corners");
}

}  // namespace swath::planning

namespace swath::core {
template <>
struct Choices<planning::PlanPattern> {
  static constexpr std::array<std::string_view, 2> names{"block", "calibration"};
};
}  // namespace swath::core
