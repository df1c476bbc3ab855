// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/describe_products.h"

#include <optional>
#include <string>
#include <vector>

#include "core/config/result_visitors.h"
#include "io/survey/tree_kind.h"
#include "io/text/value_file.h"

namespace swath::io {
namespace {

using core::Value;

/// plan.json of `swath plan`.
struct PlannedFlightFacts {
  const Value& tree;
};
template <class V>
void describe(const PlannedFlightFacts& r, V& v) {
  const auto text = [&](const char* key) { return r.tree.find(key) && r.tree.find(key)->is_text() ? r.tree.find(key)->as_text() : ""; };
  const auto number = [&](const char* key) {
    const Value* found = r.tree.find(key);
    return found && found->is_number() ? std::optional(found->as_number()) : std::nullopt;
  };
  const Value* lines = r.tree.find("lines");
  v.result("format", std::string(format_of(TreeKind::planned_flight)), "What the file is.");
  v.result("name", text("name"), "Name of the plan.");
  v.result("crs", text("crs"), "CRS of its coordinates.");
  v.result("lines", lines && lines->is_array() ? lines->items().size() : 0, "Flight lines.");
  v.result("direction_deg", number("direction_deg"), core::plain(1), "Direction of the lines.");
  v.result("area_m2", number("area_m2"), core::plain(0), "Area to be flown.");
  v.result("line_length_m", number("line_length_m"), core::metres(0), "Length of all lines.");
  v.result("time_s", number("time_s"), core::seconds(0), "Time on lines and turns.");
  std::vector<std::string> warnings;
  if (const Value* own = r.tree.find("warnings"); own && own->is_array())
    for (const Value& one : own->items())
      if (one.is_text()) warnings.push_back(one.as_text());
  v.result("warnings", warnings, "What looks wrong.");
}

/// quality.xml of `report.quality`.
struct QualityXmlFacts {
  std::uint64_t reports = 0, passed = 0, missed = 0;
};
template <class V>
void describe(const QualityXmlFacts& r, V& v) {
  v.result("format", std::string("data quality by ISO 19157-2"), "Format.");
  v.result("reports", r.reports, "Measures that it reports.");
  v.result("requirements_met", r.passed, "Conformance results that are passed.");
  v.result("requirements_missed", r.missed, "Those that are not.");
  v.result("warnings", std::vector<std::string>{}, "What looks wrong.");
}

}  // namespace

Value describe_planned_flight(const Value& tree) { return core::reported(PlannedFlightFacts{tree}); }

bool looks_like_quality_xml(std::string_view start) { return start.starts_with("<?xml") && start.find(":DQ_DataQuality") != start.npos; }

Value describe_quality_xml(const std::filesystem::path& file) {
  const std::string text = read_text_file(file);
  const auto count = [&](std::string_view what) {
    std::uint64_t n = 0;
    for (size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++n;
    return n;
  };
  const std::string passed = "<mdq:pass><gco:Boolean>";
  return core::reported(QualityXmlFacts{count("<mdq:report>"), count(passed + "true"), count(passed + "false")});
}

}  // namespace swath::io
