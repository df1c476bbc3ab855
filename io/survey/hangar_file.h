// SPDX-License-Identifier: GPL-3.0-or-later
// hangar.toml: what was measured in a hangar for the lever arms of an aircraft, and the lists of it that stand in tables of their own.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "io/survey/time_tags.h"

namespace swath::io {

/// Precision of one observation that states none itself.
struct HangarInstrument {
  core::Radians angle = core::degrees(5.0 / 3600.0);
  core::Metres distance{0.002};
  core::Ratio distance_scale{2e-6};

  double distance_sigma(double metres) const { return distance.value + distance_scale.value * metres; }
};

template <class V>
void describe(HangarInstrument& i, V& v) {
  v.option("angle", i.angle, core::above(0), "Sigma of one horizontal or vertical angle, pointing included.");
  v.option("distance", i.distance, core::above(0), "Sigma of one distance: the part that does not grow.");
  v.option("distance_scale", i.distance_scale, core::at_least(0), "The part that grows with the distance, added to it.");
}

/// A point whose coordinates define the hangar's frame.
struct HangarTarget {
  std::string name;
  std::array<core::Metres, 3> at{};
};
template <class V>
void describe(HangarTarget& t, V& v) {
  v.option("name", t.name, "Name.");
  v.option("at", t.at, "x, y (level), z (up) in the hangar's frame, right-handed.");
}

/// A station of the instrument: found from its distances to targets, or with stated coordinates.
struct HangarStation {
  std::string name;
  std::optional<std::array<core::Metres, 3>> at, sigma, start;
};
template <class V>
void describe(HangarStation& s, V& v) {
  v.option("name", s.name, "Name.");
  v.option("at", s.at, "Its coordinates, where they are known; otherwise they follow from its distances to targets.");
  v.option("sigma", s.sigma, core::above(0), "Sigmas of `at`.");
  v.option("start", s.start, "Start value, needed only where the targets lie in one plane: on its side of that plane.");
  v.check(s.at.has_value() == s.sigma.has_value(), "`at` and `sigma` go together");
}

/// What a point of the aircraft stands for.
enum class HangarRole { mark, imu, scanner, antenna, fore, aft };

/// A point of the aircraft: sighted from stations, or with stated coordinates.
struct HangarPoint {
  std::string name;
  HangarRole role = HangarRole::mark;
  std::optional<std::array<core::Metres, 3>> at, sigma, start;
  std::array<core::Metres, 3> offset{};
  core::Metres offset_sigma;
};
template <class V>
void describe(HangarPoint& p, V& v) {
  v.option("name", p.name, "Name.");
  v.option("role", p.role, "imu, scanner (beam origin), antenna (phase centre), fore and aft (heading marks), or control mark.");
  v.option("at", p.at, "Coordinates in the hangar's frame, where known; otherwise from the sights at it.");
  v.option("sigma", p.sigma, core::above(0), "Sigmas of `at`; of a coordinate that is not known: a large one.");
  v.option("start", p.start, "Start value, needed only where the sights leave two positions.");
  v.option("offset", p.offset, "From the point sighted to the point meant: forward, right, down, in body axes.");
  v.option("offset_sigma", p.offset_sigma, core::at_least(0), "Sigma of each component of `offset`.");
  v.check(p.at.has_value() == p.sigma.has_value(), "`at` and `sigma` go together");
}

struct HangarDistance {
  std::string from, to;
  core::Metres distance;
  std::optional<core::Metres> sigma;
  std::string place;  ///< "file:line"
};
template <class V>
void describe(HangarDistance& d, V& v) {
  v.option("from", d.from, "Station.");
  v.option("to", d.to, "Target, or point of the aircraft.");
  v.option("distance", d.distance, core::above(0), "Slant distance.");
  v.option("sigma", d.sigma, core::above(0), "Its sigma, where it is not the instrument's.");
}

struct HangarAngle {
  std::string at, from, to;
  core::Radians angle;
  std::optional<core::Radians> sigma;
  std::string place;
};
template <class V>
void describe(HangarAngle& a, V& v) {
  v.option("at", a.at, "Station.");
  v.option("from", a.from, "The other station of the triangle.");
  v.option("to", a.to, "Point of the aircraft.");
  v.option("angle", a.angle, "Angle between the two sights in the horizontal plane, 0 to 180 deg, whichever way round.");
  v.option("sigma", a.sigma, core::above(0), "Its sigma, where it is not the instrument's.");
}

struct HangarVertical {
  std::string at, to;
  core::Radians angle;
  std::optional<core::Radians> sigma;
  std::string place;
};
template <class V>
void describe(HangarVertical& a, V& v) {
  v.option("at", a.at, "Station.");
  v.option("to", a.to, "Point of the aircraft.");
  v.option("angle", a.angle, "Vertical angle, counted as `vertical_from` says.");
  v.option("sigma", a.sigma, core::above(0), "Its sigma, where it is not the instrument's.");
}

/// How the aircraft stands in the hangar.
struct HangarAxes {
  core::Radians roll, pitch;
  core::Radians roll_sigma = core::degrees(0.1), pitch_sigma = core::degrees(0.1);
  std::optional<core::Radians> heading;
  core::Radians heading_offset;
  core::Radians heading_sigma = core::degrees(0.1);
};
template <class V>
void describe(HangarAxes& a, V& v) {
  v.option("roll", a.roll, core::within(-0.5, 0.5),
           "Roll of the IMU in the hangar, right wing down: as it reads it itself, or from levelled marks.");
  v.option("pitch", a.pitch, core::within(-0.5, 0.5), "Its pitch, nose up.");
  v.option("roll_sigma", a.roll_sigma, core::at_least(0), "Sigma of the roll.");
  v.option("pitch_sigma", a.pitch_sigma, core::at_least(0), "Sigma of the pitch.");
  v.option("heading", a.heading, core::one_turn(),
           "Its heading from the hangar's y axis, clockwise; without it the marks fore and aft give it.");
  v.option("heading_offset", a.heading_offset, "From the line of the marks (aft to fore) to the IMU's forward axis, clockwise.");
  v.option("heading_sigma", a.heading_sigma, core::at_least(0), "Sigma of the stated heading, or of heading_offset.");
}

enum class VerticalFrom { horizon, zenith };

struct HangarSurvey {
  std::string name = "hangar";
  HangarInstrument instrument;
  VerticalFrom vertical_from = VerticalFrom::horizon;
  bool elevation_signs = true;
  std::vector<HangarTarget> targets;
  std::vector<HangarStation> stations;
  std::vector<HangarPoint> points;
  std::vector<HangarDistance> distances;
  std::vector<HangarAngle> angles;
  std::vector<HangarVertical> verticals;
  HangarAxes axes;
  std::optional<std::filesystem::path> targets_file, distances_file, angles_file, verticals_file;
  core::Metres length_unit{1.0};
  AngleUnit angle_unit = AngleUnit::unstated;
  std::filesystem::path file;  ///< hangar.toml itself
};
template <class V>
void describe(HangarSurvey& h, V& v) {
  v.option("name", h.name, "Name of aircraft and hangar, for reports.");
  v.table("instrument", h.instrument, "Precision of the instrument.");
  v.option("vertical_from", h.vertical_from, "Vertical angles count from the horizon, positive upwards, or from the zenith.");
  v.option("elevation_signs", h.elevation_signs,
           "Use the tangent of vertical angles, which keeps the sign; false: their cosine, which has none.", "Jubanski et al., eq 4-8");
  v.tables("target", h.targets, "Targets with known coordinates.");
  v.tables("station", h.stations, "Stations of the instrument.");
  v.tables("point", h.points, "Points of the aircraft.");
  v.tables("distance", h.distances, "Distances from stations to targets and points.");
  v.tables("angle", h.angles, "Horizontal angles between another station and a point.");
  v.tables("vertical", h.verticals, "Vertical angles to points.");
  v.table("axes", h.axes, "How the aircraft stands in the hangar.");
  v.option("targets_file", h.targets_file, "Further targets: table with the columns name, x, y, z. Relative to this file.");
  v.option("distances_file", h.distances_file, "Further distances: from, to, distance, and sigma where stated.");
  v.option("angles_file", h.angles_file, "Further horizontal angles: at, from, to, angle, and sigma where stated.");
  v.option("verticals_file", h.verticals_file, "Further vertical angles: at, to, angle, and sigma where stated.");
  v.option("length_unit", h.length_unit, core::above(0), "Length of one unit in these tables.");
  v.option("angle_unit", h.angle_unit, "Unit of angles in these tables, of sigmas too.");
}

/// Reads hangar.toml (or the same tree as .json) and its tables. Vertical angles come out from the horizon, positive upwards, sigmas of all
/// observations filled in. Throws Error with file and line: names that are not there (with the nearest), doubled or the same for two kinds
/// of things, an observation made twice, angles outside their range, two angles of a triangle that reach 180 deg together, units not
/// stated.
HangarSurvey read_hangar(const std::filesystem::path& file);

/// The tables that read_hangar() reads besides hangar.toml.
std::vector<std::filesystem::path> hangar_tables(const HangarSurvey& hangar);

}  // namespace swath::io

namespace swath::core {
template <>
struct Choices<io::HangarRole> {
  static constexpr std::array<std::string_view, 6> names{"mark", "imu", "scanner", "antenna", "fore", "aft"};
};
template <>
struct Choices<io::VerticalFrom> {
  static constexpr std::array<std::string_view, 2> names{"horizon", "zenith"};
};
}  // namespace swath::core
