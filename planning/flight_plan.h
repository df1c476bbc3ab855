// SPDX-License-Identifier: GPL-3.0-or-later
// A flight plan: lines, what they deliver, how long it takes and what it costs. Refused where it cannot be flown.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "planning/coverage.h"
#include "planning/layout.h"
#include "planning/plan_options.h"

namespace swath::planning {

struct LineFound {
  FlightLine line;
  double lowest = 0.0, mean = 0.0, highest = 0.0;  ///< m above the ground below the line
  double seconds = 0.0, turn_seconds = 0.0;        ///< of the line; of the way to it from the line before
  std::optional<double> base_distance;             ///< m from its farthest end to the nearest base
};

template <class V>
void describe(const LineFound& l, V& v) {
  v.result("name", l.line.name, "Name of the line.");
  v.result("from", l.line.from, "East, north of its start, m.");
  v.result("to", l.line.to, "East, north of its end, m.");
  v.result("level_m", l.line.level, core::metres(1), "Height to be flown, in the height system of the terrain model.");
  v.result("scans", l.line.scans, core::plain().only_if(!l.line.scans), "The mirror stands still at nadir.");
  v.result("course_deg", core::to_degrees(l.line.course()), core::in_degrees(1), "Course, clockwise from grid north.");
  v.result("length_m", l.line.length(), core::metres(0), "Length.");
  v.result("lowest_above_ground_m", l.lowest, core::metres(0), "Least height above the ground below the line.");
  v.result("mean_above_ground_m", l.mean, core::metres(0), "Mean height above the ground below the line.");
  v.result("highest_above_ground_m", l.highest, core::metres(0), "Greatest height above the ground below the line.");
  v.result("time_s", l.seconds, core::seconds(0), "Time on the line.");
  v.result("turn_s", l.turn_seconds, core::seconds(0), "Time from the line before, with climb and straight flight on both sides.");
  v.result("base_distance_m", l.base_distance, core::metres(0), "Farthest distance from the nearest base station.");
}

/// What a swath is at the mean flying height over level ground, by the formulas of profiling.h.
struct SwathFound {
  double height = 0.0, footprint = 0.0, width = 0.0, across = 0.0, along = 0.0, density = 0.0, ground_spacing = 0.0;
  double time_of_flight = 0.0, pulses_in_air = 0.0;
};

template <class V>
void describe(const SwathFound& s, V& v) {
  v.result("height_m", s.height, core::metres(1).in_summary(), "Mean height above the ground.");
  v.result("footprint_m", s.footprint, core::metres(2).in_summary(), "Diameter of the beam on the ground.");
  v.result("width_m", s.width, core::metres(1).in_summary(), "Width of the swath.");
  v.result("spacing_across_m", s.across, core::metres(2).in_summary(), "Mean spacing of pulses along a scan line.");
  v.result("spacing_along_m", s.along, core::metres(2).in_summary(), "Mean spacing of scan lines.");
  v.result("density_per_m2", s.density, core::plain(2).in_summary(), "Pulses of one swath, mean over its width.");
  v.result("ground_spacing_m", s.ground_spacing, core::metres(2).in_summary(), "Spacing of the pulses that reach the ground.");
  v.result("time_of_flight_s", s.time_of_flight, core::plain(), "Of a pulse to the ground and back.");
  v.result("pulses_in_air", s.pulses_in_air, core::plain(2), "At a time, at the longest range.");
}

/// Distribution of a quantity over the cells of the area.
struct Spread {
  double least = 0.0, low = 0.0, median = 0.0, mean = 0.0, high = 0.0, greatest = 0.0;
};

template <class V>
void describe(const Spread& s, V& v) {
  v.result("least", s.least, "Least of all cells.");
  v.result("p05", s.low, "5 % of the cells lie below.");
  v.result("median", s.median, "Half of the cells lie below.");
  v.result("mean", s.mean, "Mean.");
  v.result("p95", s.high, "95 % of the cells lie below.");
  v.result("greatest", s.greatest, "Greatest of all cells.");
}

struct EyeSafetyFound {
  double height = 0.0, with_binoculars = 0.0, exposure = 0.0, pulses = 0.0, lowest = 0.0;
};

template <class V>
void describe(const EyeSafetyFound& e, V& v) {
  v.result("safe_from_m", e.height, core::metres(0).in_summary(), "Height from which an eye is safe (IEC 60825-1:2014).");
  v.result("safe_with_binoculars_from_m", e.with_binoculars, core::metres(0), "The same behind optics of 50 mm.");
  v.result("exposure_j_per_m2", e.exposure, "Permissible exposure of one pulse.");
  v.result("pulses", e.pulses, core::plain(1), "Pulses of one passage of the beam that meet an eye.");
  v.result("lowest_above_ground_m", e.lowest, core::metres(0), "Least height above the ground of all lines.");
}

/// Errors of a point at one scan angle, by source (along track, across, up; m).
struct BudgetRow {
  std::string source;
  Eigen::Vector3d error = Eigen::Vector3d::Zero();
};
template <class V>
void describe(const BudgetRow& r, V& v) {
  v.result("source", r.source, "Source of the error.");
  v.result("error_m", r.error, "Along track, across (to port), up, m.");
}
struct BudgetFound {
  double angle = 0.0, height = 0.0;  ///< rad, m
  std::vector<BudgetRow> rows;
  Eigen::Vector3d total = Eigen::Vector3d::Zero();
};
template <class V>
void describe(const BudgetFound& b, V& v) {
  v.result("scan_angle_deg", core::to_degrees(b.angle), core::in_degrees(1), "Scan angle.");
  v.result("height_m", b.height, core::metres(1), "Height above the ground.");
  v.tables("sources", b.rows, "Errors by source, as in table 10 of Brandalize.");
  v.result("total_m", b.total, "Root of the sum of squares.");
}
/// At nadir, half way and at the edge of the field of view.
std::vector<BudgetFound> budgets_at(const core::SensorSigma& sensor, const TrajectorySigma& trajectory, double height, double speed,
                                    const std::vector<double>& angles);

/// A photogrammetric flight at the same height, for comparison (12) to (14).
struct PhotoFound {
  double planimetry = 0.0, height = 0.0, analogue_interval = 0.0, analytical_interval = 0.0, digital_interval = 0.0;
};
template <class V>
void describe(const PhotoFound& p, V& v) {
  v.result("planimetry_m", p.planimetry, core::metres(2), "Accuracy of planimetry.");
  v.result("height_m", p.height, core::metres(2), "Accuracy of heights.");
  v.result("analogue_interval_m", p.analogue_interval, core::metres(2), "Contour interval of an analogue instrument (C factor 1300).");
  v.result("analytical_interval_m", p.analytical_interval, core::metres(2), "Of an analytical plotter (2200).");
  v.result("digital_interval_m", p.digital_interval, core::metres(2), "Of a digital station with film scanned at 9 um (2133).");
}

struct CostFound {
  std::string currency;
  double hours = 0.0, total = 0.0;
  std::uint64_t sorties = 0;
};
template <class V>
void describe(const CostFound& c, V& v) {
  v.result("currency", c.currency, "Currency.");
  v.result("flight_hours", c.hours, core::plain(2).in_summary(), "Hours of flight, transit included.");
  v.result("sorties", c.sorties, core::plain().in_summary(), "Sorties within the endurance.");
  v.result("total", c.total, core::plain(0).in_summary(), "Cost.");
}

struct FlightPlan {
  std::string name, crs;
  double area = 0.0, direction = 0.0;  ///< m2, rad
  std::vector<LineFound> lines;
  double line_length = 0.0, seconds = 0.0;  ///< m; s of lines and turns
  std::optional<double> least_overlap;
  SwathFound swath;
  Spread density, seen, sigma_height, sigma_horizontal;
  double unseen_share = 0.0;
  std::optional<double> below_density_share;
  std::optional<EyeSafetyFound> eye_safety;
  std::vector<BudgetFound> budget;
  PhotoFound photo;
  CostFound cost;
  std::vector<std::string> warnings;
  Coverage coverage;
};

template <class V>
void describe(const FlightPlan& p, V& v) {
  v.result("name", p.name, "Name of the plan.");
  v.result("crs", p.crs, "CRS of all coordinates.");
  v.result("area_m2", p.area, core::plain(0).in_summary(), "Area to be flown.");
  v.result("direction_deg", core::to_degrees(p.direction), core::in_degrees(1), "Direction of the lines, clockwise from grid north.");
  v.result("line_length_m", p.line_length, core::metres(0).in_summary(), "Length of all lines.");
  v.result("time_s", p.seconds, core::seconds(0).in_summary(), "Time on lines and turns.");
  v.result("least_overlap", p.least_overlap, core::share(3).in_summary(), "Least overlap of neighbouring lines, share of the swath.");
  v.table("swath", p.swath, "One swath over level ground.");
  v.table("density_per_m2", p.density, "Pulses per m2 of all lines.");
  v.table("lines_seen", p.seen, "Lines that see a cell.");
  v.table("sigma_height_m", p.sigma_height, "Sigma of the ground's height by one point.");
  v.table("sigma_horizontal_m", p.sigma_horizontal, "Radial sigma of a point's place.");
  v.result("unseen_share", p.unseen_share, core::share(), "Share of the area that no line sees.");
  v.result("below_density_share", p.below_density_share, core::share(), "Share of the area with fewer pulses than asked for.");
  v.table("eye_safety", p.eye_safety, "Eye safety.");
  v.tables("budget", p.budget, "Errors of a point by source.");
  v.table("photogrammetry", p.photo, "A photogrammetric flight at the same height, for comparison.");
  v.table("cost", p.cost, "Cost.");
  v.tables("lines", p.lines, "Lines in the order of the flight.");
  v.result("warnings", p.warnings, "What to look at before the flight.");
}

/// `area`: rings in map metres. Throws core::Error (usage) where the plan cannot be flown: density too high for the least height, ground
/// too near, eyes not safe, a gap between lines, ranges beyond the sensor's or beyond what one pulse in the air allows, area beside the
/// terrain model.
FlightPlan make_flight_plan(const PlanOptions& options, const std::vector<Ring>& area, const core::HeightField& ground);

}  // namespace swath::planning
