// SPDX-License-Identifier: GPL-3.0-or-later
// Limits of quality and how a run fared by them; a run that misses one ends with exit code 3.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/option.h"
#include "core/config/result.h"
#include "core/config/units.h"
#include "core/config/value.h"
#include "pipeline/warnings.h"

namespace swath::pipeline {

struct Limits {
  double outside = 1.0;
  double voids = 1.0;
  core::Metres truth_rms{1e9};
  core::Metres line_difference{1e9};
  double contradictions = 1e9;
  core::Metres overlap_difference{1e9}, nva{1e9}, vva{1e9}, planimetry{1e9}, surface_difference{1e9};
  double void_share = 1.0, quality_level = 1e9;
};

template <class V>
void describe(Limits& l, V& v) {
  v.option("outside", l.outside, core::within(0, 1), "Largest share of returns that the trajectory does not cover.");
  v.option("voids", l.voids, core::within(0, 1),
           "Largest share of holes in the DTM: cells without a height that have ground on all sides.");
  v.option("truth_rms", l.truth_rms, core::at_least(0), "Largest 3D rms of the points against truth, where truth is present.");
  v.option("line_difference", l.line_difference, core::at_least(0),
           "Largest rms difference of two lines on smooth ground before adjustment (quality.geometry).");
  v.option("contradictions", l.contradictions, core::at_least(0),
           "Largest number of warnings of quality.geometry; 0: any makes exit code 3.");
  v.option("overlap_difference", l.overlap_difference, core::at_least(0),
           "Largest rms difference of overlapping lines on smooth level ground (quality.swath).");
  v.option("void_share", l.void_share, core::within(0, 1), "Largest share of voids apart from water in the survey (quality.swath).");
  v.option("nva", l.nva, core::at_least(0), "Largest RMSE at open check points, with their own error (quality.points).");
  v.option("vva", l.vva, core::at_least(0), "Largest RMSE at vegetated check points, with their own error (quality.points).");
  v.option("planimetry", l.planimetry, core::at_least(0),
           "Largest horizontal RMSE of roofs, with the targets' own error (quality.points).");
  v.option("surface_difference", l.surface_difference, core::at_least(0),
           "Largest rms difference of the terrain model and its reference (quality.surface).");
  v.option("quality_level", l.quality_level, core::at_least(0),
           "Largest number of missed requirements (report.quality); 0: any makes exit code 3.");
}

/// What a run measured of what the limits judge, in their units; nothing where no stage measures it.
struct Measured {
  std::optional<double> outside, voids, truth_rms;
  std::optional<double> line_difference{}, contradictions{};
  std::optional<double> overlap_difference{}, void_share{}, nva{}, vva{}, planimetry{}, surface_difference{}, quality_level{};
};

/// A limit that the config sets or the run measured.
struct JudgedLimit {
  std::string_view name;
  std::optional<double> value;  ///< not finite: computed, and missed
  double limit = 0.0;
  bool is_held() const { return value && *value <= limit; }
};

template <class V>
void describe(const JudgedLimit& l, V& v) {
  v.result("name", l.name, "Key of [run.limits].");
  v.result("value", l.value, core::plain().always().only_if(l.value.has_value()), "What the run measured.");
  v.result("limit", l.limit, "The limit.");
  v.result("held", l.is_held(), core::plain().only_if(l.value.has_value()), "Is the value within the limit?");
  v.result("held", std::string_view("not judged: no stage of this run measures it"), core::plain().only_if(!l.value),
           "Why the limit is not judged.");
  v.result("excess", l.value ? *l.value - l.limit : 0.0, core::plain().always().only_if(l.value && !l.is_held()),
           "By how much the value is over the limit.");
}

std::vector<JudgedLimit> judged(const Limits& limits, const Measured& measured);

/// Of the limits in report.json, a warning for each that was missed: which, the value, the limit and by how much. Empty where all are held.
/// `stages`: those of the report, of which report.quality names the requirements that are missed; null: they are counted alone.
std::vector<Warning> missed_limits(const core::Value& judged, const core::Value* stages = nullptr);

}  // namespace swath::pipeline
