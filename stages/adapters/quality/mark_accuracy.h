// SPDX-License-Identifier: GPL-3.0-or-later
// Accuracy by check points: of a product on one kind of cover, and as the class of a map.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "quality/check_marks.h"
#include "quality/map_class.h"
#include "report/statistics.h"

namespace swath::stages {

inline constexpr const char* open_cover = "open (NVA)";
inline constexpr const char* vegetated_cover = "vegetated (VVA)";
inline constexpr const char* every_cover = "all";

/// One check point with what was found at it; NaN where there is nothing.
struct MarkFound {
  double points = 0.0, dtm = 0.0;                  ///< m, less the mark
  double sigma = 0.0, sigma_h = 0.0, slope = 0.0;  ///< m, of the points' own; rise / run
  bool is_outside = false;
};

/// The same as check_points.json lists it.
struct NamedMark {
  std::string name, cover;
  MarkFound at;
};

template <class V>
void describe(const NamedMark& r, V& v) {
  using core::metres;
  v.result("name", r.name, "Name of the check point.");
  v.result("cover", r.cover, "What covers the ground there, as stated.");
  v.result("points_m", r.at.points, metres(4), "Ground points less check point.");
  v.result("dtm_m", r.at.dtm, metres(4), "Terrain model less check point.");
  v.result("predicted_m", r.at.sigma, metres(4), "The points' own sigma; 0: none.");
  v.result("slope", r.at.slope, "Rise over run of the ground there.");
}

/// Accuracy of one product on one kind of cover.
struct CoverAccuracy {
  std::string product, cover;
  report::Statistics errors;
  double q90 = 0.0, marks_sigma = 0.0, with_marks = 0.0, without_marks = 0.0, bias_share = 0.0;
  double predicted = 0.0, error_over_sigma = 0.0;  ///< not a number where the points have no sigma
  bool is_enough = false;
};

template <class V>
void describe(const CoverAccuracy& a, V& v) {
  using core::metres;
  v.result("product", a.product, "points: ground points around the check point; dtm: the terrain model.");
  v.result("cover", a.cover, "open (NVA), vegetated (VVA), all, or one cover as stated.");
  describe(a.errors, v);
  v.result("q90", a.q90, "90 % of the absolute values are smaller.");
  v.result("sigma_of_marks_m", a.marks_sigma, metres(), "Sigma of the check points' heights, rms.");
  v.result("rmse_with_marks_m", a.with_marks, metres().in_summary(), "RMSE with the check points' own error added (ASPRS 2024).");
  v.result("without_marks_m", a.without_marks, metres(), "RMSE with it taken off (Brandalize (16)); negative: it explains more.");
  v.result("bias_share", a.bias_share, core::plain(),
           "Size of the mean over the rms: above 0.25 a systematic error is to be looked for (ASPRS 2024).");
  v.result("predicted_m", a.predicted, metres(), "Sigma to be expected: of the points and of the check points, rms.");
  v.result("error_over_sigma", a.error_over_sigma, "rms over predicted_m; 1 where the points' sigmas are true.");
  v.result("is_enough", a.is_enough, "There are 30 check points or more: fewer make no statement of accuracy.");
}

/// Every product on open and vegetated ground, on all and on each cover that the survey states. `open`: covers that count as open.
std::vector<CoverAccuracy> accuracy_of(const std::vector<quality::CheckMark>& marks, const std::vector<MarkFound>& found,
                                       const std::vector<std::string>& open);

/// Check points that an accuracy is stated by at least; ASPRS 2024 wants 30.
constexpr std::uint64_t fewest_marks_judged = 3;

/// The one of a product and cover; null where there is none, or fewer than fewest_marks_judged are compared.
const CoverAccuracy* judged_accuracy(const std::vector<CoverAccuracy>& list, const std::string& product, const std::string& cover);

struct MapOptions {
  quality::MapRule rule = quality::MapRule::decree;
  std::optional<double> scale{}, c_factor{};
  std::optional<core::Metres> interval{}, planimetry{}, flying_height{};
};

template <class V>
void describe(MapOptions& o, V& v) {
  using core::above;
  v.option("rule", o.rule, "decree: Brazil 89.817; paper: as Brandalize prints it; pcd: PEC-PCD of 2016.", "Brandalize");
  v.option("scale", o.scale, core::within(100.0, 1e7), "Scale number of the map, 1000 for 1:1000: its class of planimetry is judged.");
  v.option("interval", o.interval, above(0.0), "Interval of its contours: its class of heights is judged.");
  v.option("planimetry", o.planimetry, above(0.0),
           "Measured standard error of planimetry; unset: that of roofs, or sigma_h of the points.");
  v.option("flying_height", o.flying_height, above(0.0), "Above ground, for the C factor.");
  v.option("c_factor", o.c_factor, above(0.0), "Of an instrument to compare with: the interval that it supports from flying_height.");
  v.check(o.interval || o.scale || !(o.planimetry || o.flying_height || o.c_factor), "a class is judged by a scale, an interval or both");
  v.check(o.scale || !o.planimetry, "planimetry is judged by a scale");
  v.check(o.flying_height || !o.c_factor, "a c_factor needs the flying_height");
}

struct IntervalFound {
  std::string name;
  double interval = 0.0;
};
template <class V>
void describe(const IntervalFound& r, V& v) {
  v.result("class", r.name, "Class of heights.");
  v.result("interval_m", r.interval, core::metres(2), "Closest contour interval whose class the heights reach.");
}

struct MapClassFound {
  std::string rule, plan_from;
  std::optional<double> ep_height{}, q90_height{}, ep_plan{}, c_factor{}, interval_by_c{};
  std::optional<std::string> height_class{}, plan_class{}, both{};
  std::vector<IntervalFound> intervals{};
};

template <class V>
void describe(const MapClassFound& r, V& v) {
  using core::metres;
  v.result("rule", r.rule, "Rule that the classes follow.");
  v.result("ep_height_m", r.ep_height, metres(), "Standard error of heights: rms at all check points.");
  v.result("q90_height_m", r.q90_height, metres(), "90 % of their absolute errors are smaller (PEC).");
  v.result("height_class", r.height_class, core::plain().in_summary(), "Class of heights; none: worse than all.");
  v.result("ep_plan_m", r.ep_plan, metres(), "Standard error of planimetry.");
  v.result("ep_plan_from", r.plan_from, core::plain().only_if(r.ep_plan.has_value()), "Where it comes from.");
  v.result("plan_class", r.plan_class, core::plain().in_summary(), "Class of planimetry; none: worse than all.");
  v.result("class", r.both, core::plain().in_summary(), "Class of the map, the worse of the two.");
  v.tables("intervals", r.intervals, "Closest contour interval of each class.");
  v.result("c_factor", r.c_factor, "Flying height over the closest interval of class A (Brandalize (14)).");
  v.result("interval_by_c_m", r.interval_by_c, metres(2), "Interval that map.c_factor supports from the flying height.");
}

/// `heights`: of all check points; `roofs`: horizontal RMSE by roofs; `sigma_h`: median of the points' own, 0 where they have none. Nothing
/// where neither scale nor interval is asked for.
std::optional<MapClassFound> map_class_of(const MapOptions& o, const CoverAccuracy* heights, std::optional<double> roofs, double sigma_h);

}  // namespace swath::stages
