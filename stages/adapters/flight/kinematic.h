// SPDX-License-Identifier: GPL-3.0-or-later
// Positions of the GNSS antenna at events.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/option.h"
#include "core/config/result.h"
#include "stages/once.h"
#include "trajectory/event_positions.h"

namespace swath::stages {

struct KinematicStageOptions : trajectory::KinematicOptions {
  trajectory::Interpolator method = trajectory::Interpolator::kalman;
  std::string file = "events.csv";
  bool leave_one_out = false;
};

template <class V>
void describe(KinematicStageOptions& o, V& v) {
  v.option("method", o.method, "Kalman filter of the window; or, to compare, line, 2nd-degree polynomial or RTS smoother.", "Jubanski2005");
  v.option("file", o.file, "Name of the table of events within the output.");
  v.option("leave_one_out", o.leave_one_out, "Write the leave-one-out test of all four methods (leave_one_out.txt, .png, .svg).");
  describe(static_cast<trajectory::KinematicOptions&>(o), v);
}

struct KinematicFindings {
  std::string method;
  std::uint64_t fixes = 0, gaps = 0;
  double longest_step = 0.0;
  std::uint64_t events = 0, with_position = 0;
  std::optional<Eigen::Vector3d> formal{}, empirical{};
  std::optional<trajectory::LeaveOneOut> leave_one_out{};
};

template <class V>
void describe(const KinematicFindings& r, V& v) {
  using core::metres;
  v.result("method", r.method, core::plain().in_summary(), "What gave the positions.");
  v.result("fixes", r.fixes, "GNSS fixes that were used.");
  v.result("gaps", r.gaps, "Gaps of the GNSS record.");
  v.result("longest_step_without_gap_s", r.longest_step, core::seconds().always(), "Longest step between fixes that is not a gap.");
  v.result("events", r.events, core::plain().in_summary(), "Events.");
  v.result("events_with_position", r.with_position, core::plain().in_summary(), "Of those: events with a position.");
  v.result("median_formal_sigma_m", r.formal, metres(4), "Median of the filter's own sigmas: east, north, height.");
  v.result("empirical_sigma_m", r.empirical, metres(4), "Sigmas by the leave-one-out test: east, north, height.");
  v.table("leave_one_out", r.leave_one_out, "Each fix against what the others say of it.");
}

KinematicFindings position_events(const core::GnssData& gnss, const core::EventData& events, const Context& context,
                                  const KinematicStageOptions& o, const Output& to, core::Tally& tally);
void expect_crs(const Context& context, const KinematicStageOptions&);
std::vector<std::string> kinematic_products(const KinematicStageOptions& o);

}  // namespace swath::stages
