// SPDX-License-Identifier: GPL-3.0-or-later
// What a receiver of a lower rate would have given: fixes thinned, tested, and compared with those that were taken away.
#pragma once

#include <string>
#include <vector>

#include "core/config/result.h"
#include "trajectory/leave_one_out.h"

namespace swath::trajectory {

struct RateTest {
  double rate = 0.0;  ///< fixes per second
  LeaveOneOut leave_one_out;
  size_t withheld = 0;        ///< fixes that were taken away, with a full window around them
  MethodStatistics at_those;  ///< each less the position interpolated at its time; sigmas hold its own white error
};

template <class V>
void describe(const RateTest& r, V& v) {
  v.result("rate_hz", r.rate, core::Form{"Hz"}, "Fixes per second that were kept.");
  v.table("leave_one_out", r.leave_one_out, "Each kept fix against its prediction from the others.");
  v.result("withheld", r.withheld, "Fixes that were taken away and compared.");
  v.table("withheld_kalman", r.at_those[0], "Those less the Kalman filter's position at their time.");
  v.table("withheld_straight_line", r.at_those[1], "Those less the straight line's.");
  v.table("withheld_parabola", r.at_those[2], "Those less the polynomial's of 2nd degree.");
  v.table("withheld_rts", r.at_those[3], "Those less the smoother's.");
}

/// `fixes` thinned to `rate` per second: those nearest to its instants. The record's own rate or a higher one: nothing is taken away.
RateTest test_rate(const PointFixes& fixes, double rate, const std::vector<LineSpan>& lines, const KinematicOptions& options);

/// The rates side by side, in centimetres.
std::string table_of(const std::vector<RateTest>& rates);

}  // namespace swath::trajectory
