// SPDX-License-Identifier: GPL-3.0-or-later
// Options of the flight.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "io/survey/survey.h"

namespace swath::simulate {

enum class FlightPattern {
  block,        ///< parallel lines, and lines across them
  calibration,  ///< over one place in many ways: along, across, at the swath's edge, without scan, at two heights
};

/// A line to be flown, in place of a pattern.
struct LineOptions {
  std::string name;
  std::array<core::Metres, 2> from{}, to{};
  core::Metres height;
  bool scans = true;
};

template <class V>
void describe(LineOptions& l, V& v) {
  v.option("name", l.name, "Name of the line.");
  v.option("from", l.from, "Easting and northing of its start.");
  v.option("to", l.to, "Easting and northing of its end.");
  v.option("height", l.height, core::within(-500, 14000), "Height to be flown, in the height system of the ground.");
  v.option("scans", l.scans, "false: the mirror stands still at nadir.");
}

struct FlightOptions {
  FlightPattern pattern = FlightPattern::block;
  core::Metres height{350.0};
  std::optional<core::Metres> second_height;
  core::MetresPerSecond speed{50.0};
  std::optional<int> lines;
  std::optional<core::Metres> line_length;
  double overlap = 0.4;
  int cross_lines = 1;
  bool edge_lines = true, profile_lines = true, opposite = true;
  core::Radians direction = core::degrees(60.0);
  core::Radians bank = core::degrees(22.0);
  core::Seconds lead{5.0};
  core::Seconds still;
  double turbulence = 1.0;
  core::MetresPerSecond wind{4.0};
  core::Radians wind_from = core::degrees(300.0);
  std::vector<LineOptions> line;
  std::vector<io::TrajectoryFile> along;
  core::Seconds along_knots{0.1};

  /// Height of the calibration flight's second level above the ground, m; 0 where there is none.
  double upper_height() const;
  /// Greatest and least height of the lines above the ground in the middle of the area, which is at height `ground`.
  double highest(double ground) const;
  double lowest(double ground) const;
};

template <class V>
void describe(FlightOptions& f, V& v) {
  v.option("pattern", f.pattern,
           "block: parallel lines and cross lines; calibration: pairs of lines over the area's middle, along, across, past it at the "
           "swath's edge, without scan, and at a second height.");
  v.option("height", f.height, core::within(20, 5000), "Flying height above the ground in the middle of the area.");
  v.option("second_height", f.second_height, core::within(0, 8000),
           "Second height of a calibration flight, 0: none; default 11/7 of the first (1100 m over 700 m).");
  v.option("speed", f.speed, core::within(5, 120), "Ground speed.");
  v.option("lines", f.lines, core::within(1, 200), "Parallel flight lines (default 3); calibration: only the first N lines (default all).");
  v.option("line_length", f.line_length, core::within(20, 1e5),
           "Length of a flight line; default the area's (calibration: longer side plus 0.7 of the height).");
  v.option("overlap", f.overlap, core::within(-1.0, 0.95), "Share of the swath that neighbouring lines have in common (block).");
  v.option("cross_lines", f.cross_lines, core::within(0, 50), "Lines flown across the others (calibration: at each height).");
  v.option("edge_lines", f.edge_lines, "Calibration: two lines that pass the middle at the swath's edge, one on each side.");
  v.option("profile_lines", f.profile_lines, "Calibration: two lines along the middle with the mirror standing still at nadir.");
  v.option("opposite", f.opposite, "Calibration: the second line of each pair is flown against the first; false: both in one direction.");
  v.option("direction", f.direction, core::within(0, 2 * core::pi), "Direction of the first line, clockwise from grid north.");
  v.option("bank", f.bank, core::within(0.05, 1.0), "Bank of turns between lines.");
  v.option("lead", f.lead, core::within(1, 300), "Straight flight before and after each line.");
  v.option("still", f.still, core::within(0, 3600), "Stand on the ground before take-off and climb; 0: the flight begins in the air.");
  v.option("turbulence", f.turbulence, core::within(0, 5), "Factor on the amplitudes of turbulence (1: about 1 deg of roll, 0.3 m).");
  v.option("wind", f.wind, core::within(0, 40), "Wind, which the aircraft meets by crabbing.");
  v.option("wind_from", f.wind_from, core::within(0, 2 * core::pi), "Direction the wind comes from, clockwise from grid north.");
  v.tables("line", f.line, "Lines to be flown one after the other, in place of a pattern, as `swath plan` writes them.");
  v.tables("along", f.along,
           "Trajectory files to fly along, in place of lines: as in survey.toml, relative to the working folder; their time holds. Without "
           "laser.");
  v.option("along_knots", f.along_knots, core::within(0.01, 10),
           "Spacing of the knots of the splines along that trajectory; faster motion is smoothed away.");
  v.check(f.line.empty() || f.along.empty(), "lines and a trajectory to fly along exclude each other");
  v.check(f.wind.value < 0.8 * f.speed.value, "the wind must be well below the aircraft's speed");
  v.check(!f.second_height || f.second_height->value == 0.0 || f.second_height->value >= 20.0, "the second height is 0 or at least 20 m");
}

}  // namespace swath::simulate

namespace swath::core {
template <>
struct Choices<simulate::FlightPattern> {
  static constexpr std::array<std::string_view, 2> names{"block", "calibration"};
};
}  // namespace swath::core
