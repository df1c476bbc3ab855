// SPDX-License-Identifier: GPL-3.0-or-later
// A trajectory against a better known one: errors, their statistics, and whether the printed sigmas are true.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "core/config/result.h"
#include "core/geo/frames.h"
#include "core/records/trajectory_data.h"
#include "core/records/trajectory_errors.h"
#include "trajectory/trajectory.h"

namespace swath::trajectory {

/// Truth is interpolated to the time of each record (Trajectory::pose_at); axes are those of the true position; angles are differences
/// brought to (-pi, pi].
core::TrajectoryErrors errors_against(const core::TrajectoryData& trajectory, const Trajectory& truth);

/// Of one component; m or rad.
struct ErrorMeasures {
  double mean = 0.0, rms = 0.0;
  double largest = 0.0;     ///< of |error|
  double over_sigma = 0.0;  ///< rms of error / sigma, 1 where the sigmas are true; 0 where there are none
};

struct Comparison {
  std::size_t compared = 0;
  std::array<ErrorMeasures, 6> component;  ///< north, east, down, roll, pitch, heading

  static constexpr std::array<std::string_view, 6> names{"north", "east", "down", "roll", "pitch", "heading"};
};

/// Of one component as a report shows it: metres or arc seconds.
template <bool is_angle>
struct ErrorsIn {
  ErrorMeasures measures{};
};

template <bool is_angle, class V>
void describe(const ErrorsIn<is_angle>& r, V& v) {
  const auto& [mean, rms, largest, over_sigma] = r.measures;
  const core::Form form = (is_angle ? core::Form{"arcsec", 1} : core::metres()).always();
  const double factor = is_angle ? core::to_degrees(1.0) * 3600.0 : 1.0;
  v.result(is_angle ? "mean_arcsec" : "mean_m", mean * factor, form, "Mean error.");
  v.result(is_angle ? "rms_arcsec" : "rms_m", rms * factor, form, "RMS error.");
  v.result(is_angle ? "max_arcsec" : "max_m", largest * factor, form, "Largest absolute error.");
  v.result("error_over_sigma", over_sigma, core::plain(2).only_if(over_sigma > 0.0),
           "RMS of error / sigma: 1 where the sigmas are right; absent where there are none.");
}

template <class V>
void describe(const Comparison& r, V& v) {
  v.result("compared", r.compared, "Records that were compared.");
  const auto one = [&]<bool is_angle>(size_t c, ErrorsIn<is_angle> e, const char* doc) {
    e.measures = r.component[c];
    v.table(Comparison::names[c], r.compared > 0 ? std::optional(e) : std::nullopt, doc);
  };
  for (size_t c = 0; c < 3; ++c) one(c, ErrorsIn<false>(), "Error of the position along this axis.");
  for (size_t c = 3; c < 6; ++c) one(c, ErrorsIn<true>(), "Error of this angle.");
}

/// A trajectory against the truth of a simulated survey.
struct TruthComparison {
  std::size_t outside = 0;
  Comparison all;
  std::optional<Comparison> lines{};
};

template <class V>
void describe(const TruthComparison& r, V& v) {
  v.result("outside_truth", r.outside, core::if_any(), "Records that the truth does not cover.");
  v.table("all", r.all, "Errors of all records.");
  v.table("lines", r.lines, "Errors within the flight lines.");
}

/// Measures of the errors within spans of time; no spans: of all.
Comparison compare(const core::TrajectoryErrors& errors, const std::vector<Span>& within = {});

}  // namespace swath::trajectory
