// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/limits.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <string_view>

namespace swath::pipeline {
namespace {

using core::Value;

struct Kind {
  std::string_view name, what;
  double scale;
  const char* unit;
};
constexpr std::string_view level_limit = "quality_level";
constexpr std::array<Kind, 12> kinds{{{"outside", "returns that the trajectory does not cover", 100.0, "%"},
                                      {"voids", "holes in the DTM", 100.0, "%"},
                                      {"truth_rms", "3D rms of the points against truth", 1.0, "m"},
                                      {"line_difference", "difference of two lines on smooth ground", 1.0, "m"},
                                      {"contradictions", "warnings of the flight's geometry", 1.0, ""},
                                      {"overlap_difference", "difference of overlapping lines on smooth level ground", 1.0, "m"},
                                      {"void_share", "voids apart from water", 100.0, "%"},
                                      {"nva", "RMSE at open check points, with their own error", 1.0, "m"},
                                      {"vva", "RMSE at vegetated check points, with their own error", 1.0, "m"},
                                      {"planimetry", "horizontal RMSE of roofs, with the targets' own error", 1.0, "m"},
                                      {"surface_difference", "rms difference of the terrain model and its reference", 1.0, "m"},
                                      {level_limit, "missed requirements of the quality level", 1.0, ""}}};

std::string text_of(double value, const Kind& kind) {
  char text[48];
  std::snprintf(text, sizeof text, *kind.unit ? "%.4g %s" : "%.4g", kind.scale * value, kind.unit);
  return text;
}

/// Null: computed, and not finite.
double number_of(const Value& v) { return v.is_number() ? v.as_number() : std::numeric_limits<double>::quiet_NaN(); }

const Kind& kind_of(std::string_view name) {
  return *std::find_if(kinds.begin(), kinds.end(), [&](const Kind& k) { return k.name == name; });
}

/// "nominal pulse density of all lines (ANPD) 1.2 1/m2 (at least 2)".
std::string text_of(const Value& requirement) {
  const std::string& unit = requirement.find("unit")->as_text();
  const bool at_least = requirement.find("at_least")->as_bool();
  char text[96];
  std::snprintf(text, sizeof text, " %.4g%s (at %s %.4g)", number_of(*requirement.find("value")), unit.empty() ? "" : (" " + unit).c_str(),
                at_least ? "least" : "most", requirement.find("limit")->as_number());
  return requirement.find("what")->as_text() + text;
}

/// "2 of 5 requirements of QL2 are missed (run.limits.quality_level allows 0): ..."
std::string missed_requirements(double missed, double allowed, const Value* stages) {
  const auto whole = [](double v) { return text_of(v, kind_of(level_limit)); };
  std::string of, named, level = "the quality level";
  if (stages)
    for (const Value& stage : stages->items()) {
      const Value* findings = stage.find("findings");
      const Value* requirements = findings ? findings->find("requirements") : nullptr;
      if (!requirements) continue;
      if (const Value* judged = findings->find("judged")) of = " of " + std::to_string(judged->as_int());
      if (const Value* name = findings->find("quality_level"); name && name->as_text() != "none") level = name->as_text();
      for (const Value& one : requirements->items())
        if (const Value* met = one.find("met"); met && !met->as_bool()) named += (named.empty() ? ": " : ", ") + text_of(one);
    }
  return whole(missed) + of + (missed == 1.0 && of.empty() ? " requirement of " : " requirements of ") + level +
         (missed == 1.0 ? " is missed" : " are missed") + " (run.limits.quality_level allows " + whole(allowed) + ")" + named;
}

}  // namespace

std::vector<JudgedLimit> judged(const Limits& limits, const Measured& measured) {
  const Limits none;
  std::vector<JudgedLimit> list;
  const auto judge = [&](const Kind& kind, std::optional<double> value, double limit, double no_limit) {
    if (value || limit < no_limit) list.push_back({kind.name, value, limit});
  };
  judge(kinds[0], measured.outside, limits.outside, none.outside);
  judge(kinds[1], measured.voids, limits.voids, none.voids);
  judge(kinds[3], measured.line_difference, limits.line_difference.value, none.line_difference.value);
  judge(kinds[4], measured.contradictions, limits.contradictions, none.contradictions);
  judge(kinds[2], measured.truth_rms, limits.truth_rms.value, none.truth_rms.value);
  judge(kinds[5], measured.overlap_difference, limits.overlap_difference.value, none.overlap_difference.value);
  judge(kinds[6], measured.void_share, limits.void_share, none.void_share);
  judge(kinds[7], measured.nva, limits.nva.value, none.nva.value);
  judge(kinds[8], measured.vva, limits.vva.value, none.vva.value);
  judge(kinds[9], measured.planimetry, limits.planimetry.value, none.planimetry.value);
  judge(kinds[10], measured.surface_difference, limits.surface_difference.value, none.surface_difference.value);
  judge(kinds[11], measured.quality_level, limits.quality_level, none.quality_level);
  return list;
}

std::vector<Warning> missed_limits(const Value& judged, const Value* stages) {
  std::vector<Warning> out;
  for (const Value& one : judged.items()) {
    const Value* over = one.find("excess");
    if (!over) continue;
    const std::string& name = one.find("name")->as_text();
    const Kind& kind = kind_of(name);
    const double value = number_of(*one.find("value")), limit = one.find("limit")->as_number(), excess = number_of(*over);
    if (name == level_limit) {
      out.push_back({"limit." + name,
                     missed_requirements(value, limit, stages),
                     {{"value", value, {}}, {"limit", limit, {}}, {"excess", excess, {}}}});
      continue;
    }
    out.push_back(
        {"limit." + name,
         "run.limits." + name + " = " + text_of(limit, kind) + " is exceeded by " + text_of(excess, kind) + ": " + std::string(kind.what) +
             " " + text_of(value, kind),
         {{"value", kind.scale * value, kind.unit}, {"limit", kind.scale * limit, kind.unit}, {"excess", kind.scale * excess, kind.unit}}});
  }
  return out;
}

}  // namespace swath::pipeline
