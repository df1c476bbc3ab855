// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/limits.h"

#include <array>
#include <cstdio>
#include <string_view>

namespace swath::pipeline {
namespace {

using core::Value;

struct Kind {
  std::string_view name, what;
  double scale;
  const char* unit;
};
constexpr std::array<Kind, 5> kinds{{{"outside", "returns that the trajectory does not cover", 100.0, "%"},
                                     {"voids", "holes in the DTM", 100.0, "%"},
                                     {"truth_rms", "3D rms of the points against truth", 1.0, "m"},
                                     {"line_difference", "difference of two lines on smooth ground", 1.0, "m"},
                                     {"contradictions", "warnings of the flight's geometry", 1.0, ""}}};

std::string text_of(double value, const Kind& kind) {
  char text[48];
  std::snprintf(text, sizeof text, *kind.unit ? "%.4g %s" : "%.4g", kind.scale * value, kind.unit);
  return text;
}

}  // namespace

Value judged(const Limits& limits, const Measured& measured) {
  const Limits none;
  Value list = Value::array();
  const auto judge = [&](const Kind& kind, std::optional<double> value, double limit, double no_limit) {
    if (!value && limit >= no_limit) return;
    Value one = Value::object();
    one["name"] = kind.name;
    if (value) one["value"] = *value;
    one["limit"] = limit;
    if (!value)
      one["held"] = "not judged: no stage of this run measures it";
    else
      one["held"] = *value <= limit;
    if (value && !(*value <= limit)) one["excess"] = *value - limit;
    list.push(std::move(one));
  };
  judge(kinds[0], measured.outside, limits.outside, none.outside);
  judge(kinds[1], measured.voids, limits.voids, none.voids);
  judge(kinds[3], measured.line_difference, limits.line_difference.value, none.line_difference.value);
  judge(kinds[4], measured.contradictions, limits.contradictions, none.contradictions);
  judge(kinds[2], measured.truth_rms, limits.truth_rms.value, none.truth_rms.value);
  return list;
}

std::vector<std::string> missed_limits(const Value& judged) {
  std::vector<std::string> lines;
  for (const Value& one : judged.items()) {
    const Value* excess = one.find("excess");
    if (!excess) continue;
    for (const Kind& kind : kinds)
      if (one.find("name")->as_text() == kind.name)
        lines.push_back("run.limits." + std::string(kind.name) + " = " + text_of(one.find("limit")->as_number(), kind) +
                        " is exceeded by " + text_of(excess->as_number(), kind) + ": " + std::string(kind.what) + " " +
                        text_of(one.find("value")->as_number(), kind));
  }
  return lines;
}

}  // namespace swath::pipeline
