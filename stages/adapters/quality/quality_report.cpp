// SPDX-License-Identifier: GPL-3.0-or-later
// What the quality stages before it have found, judged by a quality level, as one page and as XML.
#include "io/text/output_file.h"
#include "stages/adapters/quality/quality_facts.h"
#include "stages/adapters/quality/quality_stages.h"
#include "stages/tile.h"

namespace swath::stages {
namespace {

struct QualityReportOptions {
  quality::StatedLimits limits{};
};

template <class V>
void describe(QualityReportOptions& o, V& v) {
  v.table("limits", o.limits, "Limits in place of those of quality.swath's quality_level.");
}

struct QualityReportFindings {
  std::string level = "none";
  std::uint64_t judged = 0, missed = 0;
  std::vector<quality::Requirement> requirements{};
  std::vector<std::string> not_judged{};
};

template <class V>
void describe(const QualityReportFindings& r, V& v) {
  v.result("quality_level", r.level, core::plain().in_summary(), "The level that is judged by, as quality.swath states it.");
  v.result("judged", r.judged, core::plain().in_summary(), "Requirements that were judged.");
  v.result("missed", r.missed, core::plain().in_summary().limited_by("quality_level"), "Those of them that are missed.");
  v.tables("requirements", r.requirements, "What the level and the stated limits require.");
  v.result("not_judged", r.not_judged, "What no stage measured, as sentences.");
}

QualityReportFindings write_quality(const MergeJob&, const Context& context, const QualityReportOptions& o) {
  const QualityFacts facts = quality_facts(context, o.limits);
  const QualitySheet page = quality_page(facts);
  io::write_text_file(context.output / "quality.html", page.html());
  io::write_text_file(context.output / "quality.pdf", page.pdf());
  io::write_text_file(context.output / "quality.xml", quality_xml(facts));
  return {facts.level, facts.judged(), facts.missed(), facts.requirements, facts.not_judged};
}

}  // namespace

Entry quality_report_stage() {
  return merge<write_quality>("report.quality",
                              "What the quality stages found, judged by a quality level: quality.html, quality.pdf and ISO 19157 XML.",
                              {.products = [](const QualityReportOptions&) {
                                return std::vector<std::string>{"quality.html", "quality.pdf", "quality.xml"};
                              }});
}

}  // namespace swath::stages
