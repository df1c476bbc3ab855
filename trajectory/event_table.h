// SPDX-License-Identifier: GPL-3.0-or-later
// The positions of events as a table, and what the report says of them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>

#include "core/config/result.h"
#include "core/geo/crs.h"
#include "core/records/event_data.h"
#include "core/records/gnss_data.h"
#include "core/report.h"
#include "trajectory/event_comparison.h"
#include "trajectory/event_positions.h"
#include "trajectory/events_outside.h"
#include "trajectory/rate_test.h"

namespace swath::trajectory {

/// The fixes that are of use; the others are counted.
core::GnssData usable_fixes(const core::GnssData& gnss, core::Tally& tally);

/// CSV, one row per event, metres and m/s (easting, northing and height: units of the CRS); fields without a value are empty.
std::string table_of(const core::EventData& events, const std::vector<EventPosition>& solved, const core::Crs& crs, double vertical_unit);

/// Counts events without a position, and doubtful ones. Throws core::Error where all lie outside the fixes.
void count_events(const core::EventData& events, const core::GnssData& gnss, const std::vector<EventPosition>& solved,
                  const std::string& survey, core::Tally& tally);

/// What moves the antenna, as the fixes show it.
struct MotionFigures {
  size_t pieces = 0;
  Eigen::Vector3d white = Eigen::Vector3d::Ones(), time = white, acceleration = white;
};

template <class V>
void describe(const MotionFigures& r, V& v) {
  v.result("pieces", r.pieces, "Pieces of the flight, each with an acceleration of its own.");
  v.result("white_sigma_over_stated", r.white, core::plain(2), "White error of the fixes over their stated sigma: east, north, height.");
  v.result("acceleration_time_s", r.time, core::seconds(2), "Correlation time of the acceleration.");
  v.result("median_acceleration_m_s2", r.acceleration, core::Form{"m/s2", 3}, "Median over the pieces of its standard deviation.");
}
MotionFigures figures_of(const MotionModel& model);

struct EventFigures {
  std::string method;
  std::uint64_t fixes = 0, gaps = 0;
  double longest_step = 0.0;
  std::uint64_t events = 0, with_position = 0;
  std::optional<Eigen::Vector3d> sigma{};
  MotionFigures motion{};
  LeaveOneOut leave_one_out{};
  std::vector<RateTest> rates{};
  std::vector<PlaceDifferences> comparisons{};
  std::vector<EventsOutside> outside{};
};

template <class V>
void describe(const EventFigures& r, V& v) {
  using core::metres;
  v.result("method", r.method, core::plain().in_summary(), "What gave the positions.");
  v.result("fixes", r.fixes, "GNSS fixes that were used.");
  v.result("gaps", r.gaps, "Gaps of the GNSS record.");
  v.result("longest_step_without_gap_s", r.longest_step, core::seconds().always(), "Longest step between fixes that is not a gap.");
  v.result("events", r.events, core::plain().in_summary(), "Events.");
  v.result("events_with_position", r.with_position, core::plain().in_summary(), "Of those: events with a position.");
  v.result("median_sigma_m", r.sigma, metres(4).in_summary(), "Median sigma of the events' positions: east, north, height.");
  v.table("motion", r.motion, "Motion between the fixes and the fixes' errors.");
  v.table("leave_one_out", r.leave_one_out, "Each fix against its prediction from the others.");
  v.tables_if(!r.rates.empty(), "rates", r.rates, "The record thinned to lower rates.");
  v.tables_if(!r.comparisons.empty(), "comparisons", r.comparisons, "Positions by two techniques, and against the recorder's own places.");
  v.tables_if(!r.outside.empty(), "outside", r.outside, "Techniques nearly all of whose events lie outside the GNSS record.");
}

EventFigures figures_of(const core::EventData& events, const PointTrack& track, const std::vector<EventPosition>& solved,
                        Interpolator method);

}  // namespace swath::trajectory
