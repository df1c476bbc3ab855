// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/page.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "calib/report/agreement.h"
#include "calib/report/figures.h"
#include "calib/report/page_residuals.h"
#include "calib/report/page_target.h"
#include "calib/report/page_values.h"
#include "calib/report/residual_bins.h"
#include "calib/report/tables.h"
#include "calib/report/verdict.h"
#include "calib/report_units.h"
#include "core/config/units.h"
#include "report/html.h"

namespace swath::calib {
namespace {

using report::count_text;
using report::number_text;
using report::Table;
using report::Tone;

constexpr size_t most_maps = 6;  ///< pairs of lines whose maps stand in the page; all are kept as files

void findings(const PageParts& parts) {
  if (!parts.report.adjustment.findings.empty()) {
    parts.page.section("Findings");
    Table t{"findings", "What the flight does not tell, or looks wrong, and what to do about it", {}, {}, {}};
    t.columns = {{"finding", false}, {"what to do", false}, {"parameters", false}, {"outcome", false}};
    for (const calib::Finding& f : parts.report.adjustment.findings) {
      std::vector<std::string> names;
      for (const calib::Parameter p : f.parameters) names.emplace_back(words_of(p).name);
      t.rows.push_back({f.what, f.cure, joined(names), f.refuses ? "not delivered" : "warning"});
      t.tones.push_back(f.refuses ? Tone::bad : Tone::caution);
    }
    parts.page.table(t);
  }
  if (parts.report.notes.empty()) return;
  parts.page.section("Notes");
  parts.page.list(parts.report.notes);
}

void origin(const PageParts& parts) {
  const ReportOrigin& o = parts.report.origin;
  Table t{"origin", "What this was made from", {{"what", false}, {"value", false}}, {}, {}};
  const auto row = [&](const char* what, const std::string& value) {
    if (!value.empty()) t.rows.push_back({what, value});
  };
  row("made by", o.program);
  row("flown (UTC)", o.flown_from.empty() ? std::string() : o.flown_from + " to " + o.flown_to);
  row("CRS", parts.report.crs);
  for (const std::string& input : o.inputs) row("input", input);
  if (!t.rows.empty()) parts.page.table(t);
}

void corrections(const PageParts& parts) {
  const auto chart = correction_chart(parts.report);
  if (!chart) return;
  parts.page.section("Corrections of the lines");
  const bool joint = parts.report.joint;
  parts.page.paragraph(
      joint ? "What the adjustment moved and turned the smoother's trajectory by, second by second; the sigma is that of the "
              "adjusted trajectory."
            : "What each line's trajectory was moved and turned by, to be added to it; linear in time between the knots.");
  Table t{"corrections", joint ? "Largest correction of each line" : "Largest correction of each line, over its knots", {}, {}, {}};
  t.columns = {{"line"},           {joint ? "instants" : "knots"},
               {"north (cm)"},     {"east (cm)"},
               {"down (cm)"},      {"roll (arcsec)"},
               {"pitch (arcsec)"}, {"heading (arcsec)"}};
  for (const calib::LineCorrection& c : parts.report.adjustment.corrections) {
    std::vector<std::string> row{std::to_string(c.line), count_text(c.value.size())};
    for (size_t axis = 0; axis < 6; ++axis) {
      double largest = 0.0;
      for (const auto& v : c.value)
        if (std::abs(v[axis]) > std::abs(largest)) largest = v[axis];
      row.push_back(number_text(largest / (axis < 3 ? centimetre : arc_second), axis < 3 ? 2 : 1));
    }
    t.rows.push_back(std::move(row));
  }
  parts.page.table(t);
  parts.figure("corrections", *chart, "Corrections over time, with one sigma to both sides (corrections.csv).");
}

void sections(const PageParts& parts) {
  if (parts.report.sections.empty()) return;
  parts.page.section("Cross-sections");
  parts.page.paragraph("Returns near a vertical cut, by line colour. Before, the lines lie apart; after, they should lie on one another. " +
                       differences_after(parts.report));
  Table t{"sections", "Cross-sections", {}, {}, {}};
  t.columns = {{"section", false}, {"width (m)"}, {"length (m)"}, {"lines"}, {"returns before"}, {"returns after"}};
  for (const CrossSection& s : parts.report.sections) {
    const auto returns = [](const std::vector<SectionPoints>& lines) {
      return std::accumulate(lines.begin(), lines.end(), std::uint64_t{0},
                             [](std::uint64_t n, const SectionPoints& p) { return n + p.along.size(); });
    };
    t.rows.push_back({s.name, number_text(s.width, 2), number_text((s.ends[1] - s.ends[0]).norm(), 1), count_text(s.after.size()),
                      count_text(returns(s.before)), count_text(returns(s.after))});
  }
  parts.page.table(t);
  for (size_t k = 0; k < parts.report.sections.size(); ++k)
    parts.figure("section_" + std::to_string(k + 1), section_chart(parts.report, parts.report.sections[k]),
                 "Cross-section “" + parts.report.sections[k].name + "” before and after (sections.csv).");
}

void differences(const PageParts& parts) {
  if (parts.report.differences.empty()) return;
  parts.page.section("Differences between lines");
  parts.page.paragraph("Heights of one line minus heights of the other where both have smooth ground. " + differences_after(parts.report));
  Table t{"differences", "Height differences of overlapping lines, before and after", {}, {}, {}};
  t.columns = {{"line"}, {"minus line"}};
  for (const char* state : {"before", "after"})
    for (const char* measure : {"cells", "mean", "rms", "95 % within"})
      t.columns.push_back({std::string(measure) +
                           (measure == std::string_view("cells") ? std::string(", ") + state : std::string(", ") + state + " (cm)")});
  std::vector<std::pair<double, size_t>> worst;
  for (size_t k = 0; k < parts.report.differences.size(); ++k) {
    const LineDifference& d = parts.report.differences[k];
    std::vector<std::string> row{std::to_string(d.line_a), std::to_string(d.line_b)};
    for (const core::Grid* g : {&d.before, &d.after}) {
      const report::Statistics s = difference_statistics(*g);
      row.push_back(count_text(s.n));
      for (const double v : {s.mean, s.rms, s.q95}) row.push_back(number_text(v / centimetre, 2));
      if (g == &d.after) worst.emplace_back(std::isfinite(s.rms) ? -s.rms : 0.0, k);
    }
    t.rows.push_back(std::move(row));
  }
  parts.page.table(t);
  std::stable_sort(worst.begin(), worst.end());
  std::vector<size_t> shown;
  for (size_t k = 0; k < std::min(worst.size(), most_maps); ++k) shown.push_back(worst[k].second);
  std::sort(shown.begin(), shown.end());
  if (shown.size() < worst.size())
    parts.page.paragraph("Maps of the pairs with the largest differences left; those of the others are in the folder figures.");
  for (size_t k = 0; k < parts.report.differences.size(); ++k)
    for (const bool before : {true, false}) {
      const LineDifference& d = parts.report.differences[k];
      const core::Picture picture = difference_map(d, before);
      if (picture.width == 0) continue;
      const std::string pair = std::to_string(d.line_a) + "_" + std::to_string(d.line_b);
      const std::string file = "figures/difference_" + pair + (before ? "_before.png" : "_after.png");
      const std::string png = parts.keep(file, picture);
      if (std::find(shown.begin(), shown.end(), k) == shown.end()) continue;
      parts.page.figure_png(png,
                            "Line " + std::to_string(d.line_a) + " minus line " + std::to_string(d.line_b) +
                                (before ? ", before" : ", after") + " (" + difference_file(d, before) +
                                "). Mind the range of the colours, which the legend states.",
                            file);
    }
}

void joint_sections(const PageParts& parts) {
  for (const ReportSection& s : parts.report.sections_of_joint) {
    parts.page.section(s.heading);
    for (const std::string& text : s.paragraphs) parts.page.paragraph(text);
    for (const Table& t : s.tables) parts.page.table(t);
    for (const ReportSection::Figure& f : s.figures) parts.figure(f.name, f.chart, f.caption);
  }
}

void files(const PageParts& parts) {
  parts.page.section("Files beside this report");
  std::vector<std::string> items{
      parts.report.joint
          ? "adjustment.json: lines, planes, residuals and values of this report. network.json: kinds of observation, and errors "
            "against the truth of a simulated survey. calibration.json: the values for the survey's run."
      : parts.report.strips ? std::string(tree_file(parts.report)) + ": everything in this report."
                            : "calibration.json: the values for the survey's run, and everything in this report.",
      "residuals.csv: each group of returns. planes.csv: each tie plane. corrections.csv: each line's corrections.",
  };
  if (!parts.report.sections.empty()) items.emplace_back("sections.csv: the returns of the cross-sections.");
  if (!parts.report.differences.empty()) items.emplace_back("differences: height differences as GeoTIFF.");
  items.emplace_back("figures: every drawing as PNG.");
  parts.page.list(items);
}

}  // namespace

std::string calibration_page(const CalibrationReport& report, const KeepFigure& keep) {
  report::Page page(report.joint    ? "Joint adjustment of IMU, GNSS and surfaces"
                    : report.strips ? "Strip adjustment"
                                    : "Calibration report",
                    report.survey.empty() ? std::string() : "Survey " + report.survey);
  const PageParts parts{report, keep, page};
  const CalibrationVerdict v = verdict_of(report);
  page.banner(v.tone, v.text);
  origin(parts);
  findings(parts);
  const bool estimated = std::any_of(report.adjustment.estimates.begin(), report.adjustment.estimates.end(),
                                     [](const calib::Estimate& e) { return e.estimated; });
  if (report.strips) add_plane_differences(parts);
  if (!report.strips || estimated) add_values(parts);
  add_summary(parts);
  if (!report.strips || estimated) add_correlations(parts);
  joint_sections(parts);
  add_target(parts);
  add_flight(parts);
  add_residuals(parts);
  add_outliers(parts);
  add_control(parts);
  corrections(parts);
  sections(parts);
  differences(parts);
  files(parts);
  return page.html();
}

}  // namespace swath::calib
