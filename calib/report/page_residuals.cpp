// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/page_residuals.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "calib/report/figures.h"
#include "calib/report/flight_design.h"
#include "calib/report/residual_bins.h"
#include "core/config/units.h"
#include "report/html.h"

namespace swath::calib {
namespace {

using report::count_text;
using report::number_text;
using report::Table;
using report::Tone;

constexpr double residual_centimetre = 0.01;
constexpr size_t most_outliers = 40;  ///< rows; all are in residuals.csv

std::string with_unit(const char* name, const char* unit) { return std::string(name) + " (" + unit + ")"; }

/// Decimals that distinguish one end of a bin from the other.
int decimals_of(double step) { return std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9))); }

/// The measures of a bin, from "groups" on.
std::vector<std::string> measures(const ResidualBin& b) {
  std::vector<std::string> out{count_text(b.groups), count_text(b.rejected), count_text(b.returns)};
  for (const double v : {b.mean_before, b.rms_before, b.mean_after, b.rms_after, b.rms_returns})
    out.push_back(number_text(v / residual_centimetre, 2));
  out.push_back(number_text(b.largest_w, 1));
  return out;
}

const std::array<report::Column, 9>& measure_columns() {
  static const std::array<report::Column, 9> columns{{{"groups"},
                                                      {"taken out"},
                                                      {"returns"},
                                                      {"mean before (cm)"},
                                                      {"rms before (cm)"},
                                                      {"mean after (cm)"},
                                                      {"rms after (cm)"},
                                                      {"rms of returns (cm)"},
                                                      {"largest |w|"}}};
  return columns;
}

void residual_table(const PageParts& parts, BinBy by, const char* id, const char* caption, const char* unit) {
  Table t{id, caption, {}, {}, {}};
  if (by == BinBy::line) {
    t.columns = {{"line"}};
  } else {
    t.columns = {{with_unit("from", unit)}, {with_unit("to", unit)}};
  }
  t.columns.insert(t.columns.end(), measure_columns().begin(), measure_columns().end());
  for (const ResidualBin& b : residual_bins(parts.report.adjustment, parts.report.ties, by)) {
    std::vector<std::string> row;
    if (by == BinBy::line)
      row = {std::to_string(static_cast<int>(b.low))};
    else
      row = {number_text(b.low, decimals_of(b.high - b.low)), number_text(b.high, decimals_of(b.high - b.low))};
    const std::vector<std::string> rest = measures(b);
    row.insert(row.end(), rest.begin(), rest.end());
    t.rows.push_back(std::move(row));
  }
  parts.page.table(t);
}

void control_table(const PageParts& parts, const char* id, const char* caption, const std::vector<calib::ControlResidual>& rows) {
  if (rows.empty()) return;
  Table t{id, caption, {}, {}, {}};
  t.columns = {{"point", false}, {"plane"}, {"residual (cm)"}, {"sigma (cm)"}, {"redundancy"}, {"w"}, {"outcome", false}};
  for (const calib::ControlResidual& c : rows) {
    t.rows.push_back({c.name, std::to_string(c.plane), number_text(c.residual / residual_centimetre, 2),
                      number_text(c.sigma / residual_centimetre, 2), number_text(c.redundancy, 2), number_text(c.w, 1),
                      c.rejected ? "taken out" : "used"});
    t.tones.push_back(c.rejected ? Tone::caution : Tone::plain);
  }
  parts.page.table(t);
}

}  // namespace

void add_flight(const PageParts& parts) {
  parts.page.section("Design of the flight");
  const double start = first_time(parts.report.ties);
  Table t{"lines", "Flight lines", {}, {}, {}};
  t.columns = {{"line"},       {"name", false}, {"heading (deg)"}, {"height (m)"}, {"speed (m/s)"},
               {"length (m)"}, {"start (s)"},   {"duration (s)"},  {"returns"},    {"tie planes"}};
  const FlightDesign flight = flight_design(parts.report);
  for (const auto& [l, planes] : flight.lines)
    t.rows.push_back({std::to_string(l.id), l.name, number_text(core::to_degrees(l.heading), 1), number_text(l.height, 0),
                      number_text(l.speed, 1), number_text(l.length, 0), number_text(l.first - start, 1), number_text(l.last - l.first, 1),
                      count_text(l.returns), count_text(planes)});
  parts.page.table(t);
  parts.page.paragraph(
      "Heading: mean course over ground, clockwise from true north. Height: of the scanner above the ground. Start: after the first "
      "return that calibration used.");

  Table pairs{"overlaps", "Overlaps: tie planes that two lines share", {}, {}, {}};
  pairs.columns = {{"line"}, {"and line"}, {"angle between their courses (deg)"}, {"tie planes in common"}};
  for (const LinesOverlap& p : flight.pairs)
    pairs.rows.push_back(
        {std::to_string(p.lines[0]), std::to_string(p.lines[1]), number_text(core::to_degrees(p.turn), 1), count_text(p.planes)});
  parts.page.table(pairs);

  Table planes{"planes", "Tie planes", {{"kind", false}, {"planes"}, {"of them surveyed"}}, {}, {}};
  for (const auto& [kind, n] : flight.planes) planes.rows.push_back({kind, count_text(n.planes), count_text(n.surveyed)});
  parts.page.table(planes);
}

void add_residuals(const PageParts& parts) {
  parts.page.section("Residuals");
  parts.page.paragraph(
      "A group is the returns of one line on one tie plane. Its mean distance from the plane, towards the scanner, is what the adjustment "
      "makes "
      "small: before with the start values, after with the result. A slope over scan angle, range or time that is left tells of an error "
      "that "
      "the model does not hold.");
  Table total{"residuals", "All groups", {}, {measures(residual_total(parts.report.adjustment))}, {}};
  total.columns.assign(measure_columns().begin(), measure_columns().end());
  parts.page.table(total);
  struct View {
    BinBy by;
    const char *name, *heading, *id, *caption, *unit;
  };
  for (const View& v :
       {View{BinBy::line, "residuals_line", "By line", "residuals-by-line", "Residuals by flight line", ""},
        View{BinBy::angle, "residuals_angle", "By scan angle", "residuals-by-angle", "Residuals by scan angle", "deg"},
        View{BinBy::range, "residuals_range", "By range", "residuals-by-range", "Residuals by range", "m"},
        View{BinBy::time, "residuals_time", "By time", "residuals-by-time", "Residuals by time since the first return", "s"}}) {
    parts.page.section(v.heading, 3);
    residual_table(parts, v.by, v.id, v.caption, v.unit);
    parts.figure(v.name, residual_chart(parts.report, v.by),
                 std::string(v.caption) + ", one dot per group, by line colour (residuals.csv).");
  }
}

void add_outliers(const PageParts& parts) {
  parts.page.section("Outliers");
  std::vector<size_t> out;
  for (size_t k = 0; k < parts.report.adjustment.groups.size(); ++k)
    if (parts.report.adjustment.groups[k].rejected) out.push_back(k);
  if (out.empty()) {
    parts.page.paragraph("No group of returns was taken out.");
    return;
  }
  std::stable_sort(out.begin(), out.end(), [&](size_t a, size_t b) {
    return std::abs(parts.report.adjustment.groups[a].w) > std::abs(parts.report.adjustment.groups[b].w);
  });
  parts.page.paragraph("Groups that contradict the others and were taken out, the worst first. All of them are marked in residuals.csv.");
  out.resize(std::min(out.size(), most_outliers));
  Table t{"outliers", "Groups taken out", {}, {}, {}};
  t.columns = {{"plane"},     {"kind", false}, {"line"},       {"returns"},    {"time (s)"}, {"scan angle (deg)"},
               {"range (m)"}, {"before (cm)"}, {"after (cm)"}, {"redundancy"}, {"w"}};
  for (const size_t k : out) {
    const calib::GroupResidual& g = parts.report.adjustment.groups[k];
    t.rows.push_back({std::to_string(g.plane), std::string(calib::name_of(parts.report.ties.planes[g.plane].kind)),
                      std::to_string(parts.report.ties.lines[g.line].id), count_text(g.returns),
                      number_text(bin_value(g, parts.report.ties, BinBy::time), 1), number_text(core::to_degrees(g.angle), 1),
                      number_text(g.range, 0), number_text(g.before / residual_centimetre, 2),
                      number_text(g.after / residual_centimetre, 2), number_text(g.redundancy, 2), number_text(g.w, 1)});
  }
  parts.page.table(t);
}

void add_control(const PageParts& parts) {
  parts.page.section("Surveyed points");
  if (parts.report.adjustment.control.empty() && parts.report.checks.empty()) {
    parts.page.paragraph("No surveyed point took part: heights and positions are those of the trajectory.");
    return;
  }
  control_table(parts, "control", "Points that took part: distance from the adjusted plane they lie on, along its normal",
                parts.report.adjustment.control);
  if (parts.report.checks.empty()) return;
  Table t{"checks", "Check points, which took no part: height of the returns around a point minus that of the point", {}, {}, {}};
  t.columns = {{"point", false}, {"difference (cm)"}, {"sigma (cm)"}, {"difference / sigma"}};
  for (const calib::ControlResidual& c : parts.report.checks)
    t.rows.push_back(
        {c.name, number_text(c.residual / residual_centimetre, 2), number_text(c.sigma / residual_centimetre, 2), number_text(c.w, 1)});
  parts.page.table(t);
}

}  // namespace swath::calib
