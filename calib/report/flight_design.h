// SPDX-License-Identifier: GPL-3.0-or-later
// How a flight was flown, for page and files: lines, overlaps, tie planes.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "calib/report/report_data.h"
#include "core/config/result.h"

namespace swath::calib {

struct LineOnPlanes {
  ReportedLine line;
  std::uint64_t planes = 0;  ///< that it sees
};

template <class V>
void describe(const LineOnPlanes& r, V& v) {
  const ReportedLine& l = r.line;
  v.result("id", l.id, "Number of the line.");
  v.result("name", l.name, "Its name in the survey.");
  v.result("heading", l.heading, core::Form{"rad"}.always(), "Mean course over ground, clockwise from true north.");
  v.result("height", l.height, core::metres().always(), "Mean height of the scanner above the ground.");
  v.result("speed", l.speed, core::Form{"m/s"}.always(), "Mean ground speed.");
  v.result("length", l.length, core::metres().always(), "Length.");
  v.result("first", l.first, core::seconds().always(), "GPS time of the first return.");
  v.result("last", l.last, core::seconds().always(), "GPS time of the last return.");
  v.result("returns", l.returns, "Returns read.");
  v.result("planes", r.planes, "Tie planes that it sees.");
}

/// Two lines that share tie planes.
struct LinesOverlap {
  std::array<int, 2> lines{};  ///< ids
  std::uint64_t planes = 0;
  double turn = 0.0;  ///< angle between their courses, rad
};

template <class V>
void describe(const LinesOverlap& r, V& v) {
  v.result("lines", r.lines, "Numbers of the two lines.");
  v.result("planes", r.planes, "Tie planes that both see.");
  v.result("turn", r.turn, core::Form{"rad"}.always(), "Angle between their courses.");
}

struct PlanesOfKind {
  std::uint64_t planes = 0, surveyed = 0;
};

template <class V>
void describe(const PlanesOfKind& r, V& v) {
  v.result("planes", r.planes, "Tie planes.");
  v.result("surveyed", r.surveyed, "Of them with surveyed points.");
}

struct FlightDesign {
  std::vector<LineOnPlanes> lines;
  std::vector<LinesOverlap> pairs;
  std::vector<std::pair<std::string, PlanesOfKind>> planes;  ///< by name_of(TieKind)
};
FlightDesign flight_design(const CalibrationReport& report);

template <class V>
void describe(const FlightDesign& r, V& v) {
  v.tables("lines", r.lines, "Flight lines.");
  v.tables("pairs", r.pairs, "Lines that share tie planes.");
  v.named_tables("planes", r.planes, "Tie planes by kind.");
}

}  // namespace swath::calib
