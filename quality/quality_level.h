// SPDX-License-Identifier: GPL-3.0-or-later
// Quality levels of the USGS Lidar Base Specification, and how a survey fares by one.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/option.h"
#include "core/config/result.h"

namespace swath::quality {

enum class QualityLevel { none, QL0, QL1, QL2, QL3 };

/// What a level wants; lengths in m.
struct LevelLimits {
  double spacing = 0.0;     ///< ANPS, at most
  double density = 0.0;     ///< ANPD, 1/m2, at least
  double intraswath = 0.0;  ///< RMSD of one line on smooth hard ground, at most
  double interswath = 0.0;  ///< RMSD of overlapping lines there, at most
  double nva = 0.0;         ///< RMSE of heights on open ground, at most
};

/// USGS Lidar Base Specification 2025 rev. A (key USGS), tables 1, 2 and 4. Under vegetation it sets no limit. Not for QualityLevel::none.
LevelLimits limits_of(QualityLevel level);
constexpr double least_even = 0.9;  ///< share of cells of 2 ANPS with a first return (same source, spatial distribution and regularity)

/// Limits that a contract states in place of the level's.
struct StatedLimits {
  std::optional<core::Metres> spacing{}, intraswath{}, interswath{}, nva{}, vva{};
  std::optional<double> density{}, even{};
};

template <class V>
void describe(StatedLimits& o, V& v) {
  using core::above;
  v.option("spacing", o.spacing, above(0.0), "Largest nominal pulse spacing of all lines together (ANPS).", "USGS");
  v.option("density", o.density, above(0.0), "Smallest nominal pulse density of all lines together (ANPD), per square metre.", "USGS");
  v.option("even", o.even, core::within(0.0, 1.0), "Smallest share of cells of 2 ANPS with a first return.", "USGS");
  v.option("intraswath", o.intraswath, above(0.0), "Largest scatter of one line on smooth hard ground.", "USGS");
  v.option("interswath", o.interswath, above(0.0), "Largest rms difference of overlapping lines on smooth level ground.", "USGS");
  v.option("nva", o.nva, above(0.0), "Largest RMSE of heights on open ground, with the check points' own error.", "USGS");
  v.option("vva", o.vva, above(0.0), "Largest 95 % quantile of height errors under vegetation; no level limits it.", "USGS");
}

/// What a survey measured; nothing where no stage did.
struct MeasuredQuality {
  std::optional<double> spacing{}, density{}, even{}, void_area{}, intraswath{}, interswath{}, nva{}, vva{};
};

/// One requirement.
struct Requirement {
  std::string what, unit;
  std::optional<double> value{};
  double limit = 0.0;
  bool is_least = false;   ///< the value must not be below the limit; otherwise not above
  bool is_stated = false;  ///< the limit is the survey's own, not the level's
  bool is_met() const { return value && (is_least ? *value >= limit : *value <= limit); }
  bool is_missed() const { return value && !is_met(); }
};

template <class V>
void describe(const Requirement& r, V& v) {
  v.result("what", r.what, "What is required.");
  v.result("unit", r.unit, "Unit of value and limit.");
  v.result("value", r.value, core::plain().always(), "What was measured; null where no stage measured it.");
  v.result("limit", r.limit, "The limit.");
  v.result("at_least", r.is_least, "The value must not be below the limit; otherwise not above it.");
  v.result("stated", r.is_stated, "The limit was stated for this survey; otherwise it is that of the quality level.");
  v.result("met", r.is_met(), core::plain().only_if(r.value.has_value()), "Whether it is met.");
}

/// The requirements of the level with those of the contract in their place; of `none` those of the contract alone.
std::vector<Requirement> judge_level(QualityLevel level, const StatedLimits& stated, const MeasuredQuality& measured);

}  // namespace swath::quality

namespace swath::core {
template <>
struct Choices<quality::QualityLevel> {
  static constexpr std::array<std::string_view, 5> names{"none", "QL0", "QL1", "QL2", "QL3"};
};
}  // namespace swath::core
