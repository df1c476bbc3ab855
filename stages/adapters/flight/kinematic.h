// SPDX-License-Identifier: GPL-3.0-or-later
// Positions of the GNSS antenna at events.
#pragma once

#include <string>
#include <vector>

#include "core/config/option.h"
#include "stages/once.h"
#include "trajectory/event_table.h"

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

trajectory::EventFigures position_events(const core::GnssData& gnss, const core::EventData& events, const Context& context,
                                         const KinematicStageOptions& o, const Output& to, core::Tally& tally);
void expect_crs(const Context& context, const KinematicStageOptions&);
std::vector<std::string> kinematic_products(const KinematicStageOptions& o);

}  // namespace swath::stages
