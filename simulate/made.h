// SPDX-License-Identifier: GPL-3.0-or-later
// What a simulated survey holds.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "core/config/result.h"
#include "core/config/units.h"
#include "core/records/number_count.h"
#include "simulate/recorded_flight.h"

namespace swath::simulate {

struct LaserMade {
  std::uint64_t surveyed_points = 0, pulses = 0, returns = 0;
  std::map<int, std::uint64_t> by_class{}, by_number{}, by_line{};
  std::uint64_t buildings = 0, trees = 0, wires = 0, fields = 0;
  double largest_map_error = 0.0;  ///< m
};
template <class V>
void describe(const LaserMade& r, V& v) {
  const auto counts = [&v](const char* key, const std::map<int, std::uint64_t>& of, const char* doc) {
    v.tables_if(!of.empty(), key, core::counts_of(of), doc);
  };
  v.result("surveyed_points", r.surveyed_points, "Surveyed points on targets and on the ground.");
  v.result("pulses", r.pulses, "Pulses.");
  v.result("returns", r.returns, "Returns.");
  counts("returns_by_class", r.by_class, "Returns by what they hit (ASPRS class).");
  counts("returns_by_number", r.by_number, "Returns by their number within the pulse.");
  counts("returns_by_line", r.by_line, "Returns by flight line.");
  v.result("buildings", r.buildings, "Buildings of the scene.");
  v.result("trees", r.trees, "Its trees.");
  v.result("wires", r.wires, "Its wires.");
  v.result("fields", r.fields, "Its fields with a crop.");
  v.result("largest_map_error_m", r.largest_map_error, core::metres(6), "Largest error of the map's local approximation.");
}

/// In metres, and degrees.
struct SixAxes {
  std::array<double, 6> of;
};
template <class V>
void describe(const SixAxes& r, V& v) {
  v.result("north_m", r.of[0], core::metres().always(), "North.");
  v.result("east_m", r.of[1], core::metres().always(), "East.");
  v.result("up_m", r.of[2], core::metres().always(), "Up.");
  v.result("roll_deg", r.of[3] / core::degree, core::in_degrees().always(), "Roll.");
  v.result("pitch_deg", r.of[4] / core::degree, core::in_degrees().always(), "Pitch.");
  v.result("heading_deg", r.of[5] / core::degree, core::in_degrees().always(), "Heading.");
}
template <class V>
void describe(const RecordedFlight::Departure& r, V& v) {
  v.table("rms", SixAxes{r.rms}, "RMS.");
  v.table("worst", SixAxes{r.worst}, "Largest absolute value.");
}

struct Made {
  std::optional<LaserMade> laser{};
  std::optional<std::int64_t> fixes{}, events{};
  std::optional<std::uint64_t> images{}, image_points{};
  double seconds = 0.0;
  std::uint64_t lines = 0;
  std::optional<RecordedFlight::Departure> departure{};
};
template <class V>
void describe(const Made& r, V& v) {
  if (r.laser) describe(*r.laser, v);
  v.result("fixes", r.fixes, "GNSS fixes.");
  v.result("events", r.events, "Events.");
  v.result("images", r.images, "Images.");
  v.result("image_points", r.image_points, "Image points of points that two images see.");
  v.result("seconds", r.seconds, core::seconds(), "Duration of the flight.");
  v.result("lines", r.lines, "Flight lines.");
  v.table("splines_minus_trajectory", r.departure, "How far the flight is from the trajectory that it follows.");
}

}  // namespace swath::simulate
