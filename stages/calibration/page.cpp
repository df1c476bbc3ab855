// SPDX-License-Identifier: GPL-3.0-or-later
// Over 400 lines: one page, whose sections stand here in the order in which they are read, each a few tables and their columns.
#include "stages/calibration/page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/frames.h"
#include "core/units.h"
#include "report/html.h"
#include "report/page.h"
#include "stages/calibration/figures.h"
#include "stages/calibration/residual_bins.h"
#include "stages/calibration/tables.h"
#include "stages/calibration/target_tables.h"
#include "stages/calibration/verdict.h"

namespace swath::stages {
namespace {

using calib::Estimate;
using calib::Parameter;
using report::count_text;
using report::number_text;
using report::Table;
using report::Tone;

constexpr double arc_second = core::degree / 3600.0, centimetre = 0.01, millimetre = 0.001;
constexpr size_t most_outliers = 40;  ///< rows; all are in residuals.csv
constexpr size_t most_maps = 6;       ///< pairs of lines whose maps stand in the page; all are kept as files

/// How the parameters of one dimension are shown.
struct Group {
  const char *id, *title, *value_unit, *change_unit;
  double value_size, change_size;
  int value_decimals, change_decimals;
  double from;  ///< shown is value - from
  std::vector<Parameter> parameters;
};
const std::vector<Group>& value_groups() {
  static const std::vector<Group> groups{{"values-angles",
                                          "Angles",
                                          "deg",
                                          "arcsec",
                                          core::degree,
                                          arc_second,
                                          5,
                                          1,
                                          0.0,
                                          {calib::boresight_roll, calib::boresight_pitch, calib::boresight_heading, calib::scan_offset}},
                                         {"values-lengths",
                                          "Lengths",
                                          "m",
                                          "mm",
                                          1.0,
                                          millimetre,
                                          4,
                                          1,
                                          0.0,
                                          {calib::range_offset, calib::lever_forward, calib::lever_right, calib::lever_down}},
                                         {"values-scales",
                                          "Scales, as their difference from one",
                                          "ppm",
                                          "ppm",
                                          1e-6,
                                          1e-6,
                                          1,
                                          1,
                                          1.0,
                                          {calib::range_scale, calib::scan_scale}},
                                         {"values-time", "Time", "ms", "ms", 1e-3, 1e-3, 3, 3, 0.0, {calib::latency}}};
  return groups;
}

std::string headed(const char* name, const char* unit) { return std::string(name) + " (" + unit + ")"; }

/// Blanks that no line breaks at.
std::string unbroken(std::string_view text) {
  std::string out;
  for (const char c : text) out += c == ' ' ? std::string("\u00A0") : std::string(1, c);
  return out;
}

/// Decimals that tell one end of a bin from the other.
int decimals_of(double step) { return std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9))); }

std::string yes(bool v) { return v ? "yes" : "no"; }

class Maker {
 public:
  Maker(const CalibrationReport& report, const KeepFigure& keep)
      : report_(report),
        adjustment_(report.adjustment),
        keep_(keep),
        page_(report.strips ? "Strip adjustment" : "Calibration report", subtitle(report)) {}

  std::string html() {
    const Verdict v = report_.strips ? verdict_of_strips(adjustment_, *report_.strips) : verdict_of(adjustment_);
    page_.banner(v.tone, v.text);
    findings();
    if (report_.strips)
      strips();
    else
      values();
    summary();
    if (!report_.strips) correlations();
    target();
    flight();
    residuals();
    outliers();
    control();
    corrections();
    sections();
    differences();
    files();
    return page_.html();
  }

 private:
  static std::string subtitle(const CalibrationReport& r) { return r.survey.empty() ? std::string() : "Survey " + r.survey; }
  void figure(const std::string& name, const report::Chart& chart, const std::string& caption) {
    const std::string file = "figures/" + name + ".png";
    keep_(file, report::draw(chart));
    page_.figure_svg(report::svg(chart), caption, file);
  }

  void findings();
  void strips();
  void values();
  void summary();
  void value_table(const Group& group, const std::array<std::string, 5>& notes);
  void correlations();
  void target();
  void flight();
  void residuals();
  void residual_table(BinBy by, const char* id, const char* caption, const char* unit);
  void outliers();
  void control();
  void control_table(const char* id, const char* caption, const std::vector<calib::ControlResidual>& rows);
  void corrections();
  void sections();
  void differences();
  void files();

  const CalibrationReport& report_;
  const calib::Adjustment& adjustment_;
  const KeepFigure& keep_;
  report::Page page_;
};

void Maker::findings() {
  if (!adjustment_.findings.empty()) {
    page_.section("Findings");
    Table t{"findings", "What the flight does not tell, or looks wrong, and what to do about it", {}, {}, {}};
    t.columns = {{"finding", false}, {"what to do", false}, {"parameters", false}, {"outcome", false}};
    for (const calib::Finding& f : adjustment_.findings) {
      std::vector<std::string> names;
      for (const Parameter p : f.parameters) names.emplace_back(words_of(p).name);
      t.rows.push_back({f.what, f.cure, joined(names), f.refuses ? "not delivered" : "warning"});
      t.tones.push_back(f.refuses ? Tone::bad : Tone::caution);
    }
    page_.table(t);
  }
  if (report_.notes.empty()) return;
  page_.section("Notes");
  page_.list(report_.notes);
}

void Maker::value_table(const Group& g, const std::array<std::string, 5>& notes) {
  Table t{g.id, g.title, {}, {}, {}};
  t.columns = {{"parameter", false}, {headed("nominal", g.value_unit)}, {headed("value", g.value_unit)}, {headed("change", g.change_unit)}};
  static constexpr std::array<const char*, 5> sigmas{"sigma", "formal", "jackknife, lines", "jackknife, planes", "white"};
  for (size_t k = 0; k < sigmas.size(); ++k) t.columns.push_back({headed(sigmas[k], g.change_unit) + notes[k]});
  t.columns.push_back({"from the data (%)"});
  t.columns.push_back({"outcome", false});
  bool any = false;
  for (const Parameter p : g.parameters) {
    const Estimate& e = adjustment_.estimates[static_cast<size_t>(p)];
    if (!e.estimated) continue;
    any = true;
    const auto shown = [&](double v) { return number_text((v - g.from) / g.value_size, g.value_decimals); };
    std::vector<std::string> row{unbroken(words_of(p).name), shown(e.start)};
    const bool good = is_delivered(adjustment_, p);
    const double none = calib::not_known;
    row.push_back(shown(good ? e.value : none));
    for (const double v : {e.value - e.start, e.sigma, e.formal, e.jackknife_lines, e.jackknife_planes, e.white})
      row.push_back(number_text(good ? v / g.change_size : none, g.change_decimals));
    row.push_back(number_text(good ? 100.0 * e.determined : none, 1));
    row.emplace_back(good ? "delivered" : "not determined");
    t.rows.push_back(std::move(row));
    t.tones.push_back(good ? Tone::plain : Tone::bad);
  }
  if (any) page_.table(t);
}

void Maker::values() {
  page_.section("Calibration values");
  const std::array<std::string, 5> notes{
      page_.footnote(
          "The one-sigma uncertainty that is delivered in calibration.json: the formal one, enlarged where a jackknife speaks against it, with "
          "what the stated sigmas of values that were held (the lever arm) do to it."),
      page_.footnote("From the adjustment's covariance, with the trajectory's errors hanging together in time."),
      page_.footnote("How far the values scatter when one flight line at a time is left out."),
      page_.footnote("How far they scatter when one region of tie planes at a time is left out."),
      page_.footnote(
          "What the sigma would be if every return were independent and the trajectory without error. For comparison only: it is "
          "far too small, since neighbouring returns share the trajectory's errors.")};
  for (const Group& g : value_groups()) value_table(g, notes);
  std::vector<std::string> held;
  for (int k = 0; k < estimated_count; ++k)
    if (!adjustment_.estimates[static_cast<size_t>(k)].estimated) held.emplace_back(words_of(parameter_at(k)).name);
  if (!held.empty()) page_.paragraph("Held at the start value and not estimated: " + joined(held) + ".");
  page_.paragraph(
      "“From the data” is the share of the knowledge that this flight brought, the rest being the start value with its a-priori sigma.");
}

void Maker::strips() {
  page_.section("How the lines meet");
  page_.paragraph(
      "Two lines that have seen the same plane: the difference of the mean distances of their returns from it, over all planes that the "
      "two "
      "share. Before: with the trajectory as it was given. After: with the corrected one. The calibration was held.");
  Table t{"plane-differences", "Differences of lines on common planes", {}, {}, {}};
  t.columns = {{"line"}, {"and line"}, {"planes"}, {"mean before (cm)"}, {"rms before (cm)"}, {"mean after (cm)"}, {"rms after (cm)"}};
  const auto add = [&](const calib::PairOnPlanes& p, std::string a, std::string b) {
    t.rows.push_back({std::move(a), std::move(b), count_text(p.planes), number_text(p.mean_before / centimetre, 2),
                      number_text(p.rms_before / centimetre, 2), number_text(p.mean_after / centimetre, 2),
                      number_text(p.rms_after / centimetre, 2)});
  };
  for (const calib::PairOnPlanes& p : report_.strips->pairs) add(p, std::to_string(p.line_a), std::to_string(p.line_b));
  add(report_.strips->all, "all", "all");
  page_.table(t);
}

void Maker::summary() {
  Table t{"adjustment", "The adjustment", {{"figure", false}, {"value"}}, {}, {}};
  t.rows = {{"observations", count_text(adjustment_.observations)},
            {"unknowns", count_text(adjustment_.unknowns)},
            {"sigma of unit weight", number_text(adjustment_.sigma0, 3)}};
  if (!report_.strips) t.rows.push_back({"condition number of the scaled normal matrix", number_text(adjustment_.condition, 1)});
  t.rows.insert(t.rows.end(), {{"iterations", count_text(static_cast<std::uint64_t>(std::max(adjustment_.iterations, 0)))},
                               {"returns taken out", count_text(adjustment_.rejected_returns)}});
  page_.table(t);

  if (!adjustment_.components.empty()) {
    Table c{"components", "How large the errors of the observations are: stated, and as the adjustment found them", {}, {}, {}};
    c.columns = {{"observations", false}, {"stated sigma"}, {"unit", false}, {"found / stated"}, {"redundancy"}, {"outcome", false}};
    for (const calib::VarianceComponent& v : adjustment_.components) {
      const bool angle = v.name.find("angle") != std::string::npos || v.name.find("attitude") != std::string::npos;
      c.rows.push_back({v.name, number_text(v.stated / (angle ? arc_second : centimetre), 2), angle ? "arcsec" : "cm",
                        number_text(v.factor, 2), number_text(v.redundancy, 1), v.estimated ? "estimated" : "kept as stated"});
    }
    page_.table(c);
  }
}

void Maker::correlations() {
  const auto chart = correlation_chart(report_);
  if (!chart) return;
  page_.section("Correlations", 3);
  page_.paragraph(
      "Near one or minus one the two parameters can hardly be told apart on this flight: an error of the one is balanced by the other.");
  keep_("figures/correlation.png", report::draw(*chart));
  page_.figure_svg(report::svg(*chart), "Correlations between the estimated parameters.", "figures/correlation.png");
}

void Maker::target() {
  if (report_.readings.empty() && report_.flat_target.is_null()) return;
  page_.section("Flat target, analysed by itself");
  if (!report_.readings.empty()) {
    page_.paragraph(
        "The same parameters read from the edges and the plane of one flat target, by another method on the same flight. They agree where "
        "the "
        "difference stays within twice the joint sigma.");
    Table t{"readings", "Flat target beside the adjustment", {}, {}, {}};
    t.columns = {{"parameter", false}, {"unit", false}, {"adjusted"},      {"flat target"}, {"difference"},
                 {"joint sigma"},      {"readings"},    {"agrees", false}, {"from", false}};
    for (const TargetReading& r : report_.readings) {
      const calib::ParameterWords& w = words_of(r.parameter);
      const Agreement a = agreement_of(adjustment_, r);
      const double from = w.unit == "1" ? 1.0 : 0.0, none = calib::not_known;
      const double adjusted = a.known ? adjustment_.estimates[static_cast<size_t>(r.parameter)].value : none;
      t.rows.push_back({std::string(w.name), std::string(w.sigma_unit), number_text((adjusted - from) / w.sigma_size, 1),
                        number_text((r.value - from) / w.sigma_size, 1), number_text(a.known ? a.difference / w.sigma_size : none, 1),
                        number_text(a.known ? a.joint_sigma / w.sigma_size : none, 1), count_text(r.readings),
                        a.known ? yes(a.agrees) : "–", r.note});
      t.tones.push_back(!a.known || a.agrees ? Tone::plain : Tone::caution);
    }
    page_.table(t);
  }
  for (const Table& t : target_tables(report_.flat_target)) page_.table(t);
}

void Maker::flight() {
  page_.section("Design of the flight");
  const double start = first_time(report_.ties);
  Table t{"lines", "Flight lines", {}, {}, {}};
  t.columns = {{"line"},       {"name", false}, {"heading (deg)"}, {"height (m)"}, {"speed (m/s)"},
               {"length (m)"}, {"start (s)"},   {"duration (s)"},  {"returns"},    {"tie planes"}};
  for (const FlownLine& l : report_.lines)
    t.rows.push_back({std::to_string(l.id), l.name, number_text(core::to_degrees(l.heading), 1), number_text(l.height, 0),
                      number_text(l.speed, 1), number_text(l.length, 0), number_text(l.first - start, 1), number_text(l.last - l.first, 1),
                      count_text(l.returns), count_text(planes_of(report_.ties, l.id))});
  page_.table(t);
  page_.paragraph(
      "Heading: mean course over ground, clockwise from true north. Height: of the scanner above the ground. Start: after the first "
      "return that calibration used.");

  Table pairs{"overlaps", "Overlaps: tie planes that two lines share", {}, {}, {}};
  pairs.columns = {{"line"}, {"and line"}, {"angle between their courses (deg)"}, {"tie planes in common"}};
  for (size_t a = 0; a < report_.lines.size(); ++a)
    for (size_t b = a + 1; b < report_.lines.size(); ++b) {
      const FlownLine &first = report_.lines[a], &second = report_.lines[b];
      const std::uint64_t common = common_planes(report_.ties, first.id, second.id);
      if (common == 0) continue;
      pairs.rows.push_back({std::to_string(first.id), std::to_string(second.id),
                            number_text(core::to_degrees(std::abs(core::wrap_pi(second.heading - first.heading))), 1), count_text(common)});
    }
  page_.table(pairs);

  Table planes{"planes", "Tie planes", {{"kind", false}, {"planes"}, {"of them surveyed"}}, {}, {}};
  for (int k = 0; k <= static_cast<int>(calib::TieKind::target); ++k) {
    const auto kind = static_cast<calib::TieKind>(k);
    std::uint64_t all = 0, surveyed = 0;
    for (const calib::TiePlane& p : report_.ties.planes) {
      all += p.kind == kind;
      surveyed += p.kind == kind && !p.control.empty();
    }
    planes.rows.push_back({std::string(calib::name_of(kind)), count_text(all), count_text(surveyed)});
  }
  page_.table(planes);
}

/// The measures of a bin, from "groups" on.
std::vector<std::string> measures(const ResidualBin& b) {
  std::vector<std::string> out{count_text(b.groups), count_text(b.rejected), count_text(b.returns)};
  for (const double v : {b.mean_before, b.rms_before, b.mean_after, b.rms_after, b.rms_returns})
    out.push_back(number_text(v / centimetre, 2));
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

void Maker::residual_table(BinBy by, const char* id, const char* caption, const char* unit) {
  Table t{id, caption, {}, {}, {}};
  if (by == BinBy::line) {
    t.columns = {{"line"}};
  } else {
    t.columns = {{headed("from", unit)}, {headed("to", unit)}};
  }
  t.columns.insert(t.columns.end(), measure_columns().begin(), measure_columns().end());
  for (const ResidualBin& b : residual_bins(adjustment_, report_.ties, by)) {
    std::vector<std::string> row;
    if (by == BinBy::line)
      row = {std::to_string(static_cast<int>(b.low))};
    else
      row = {number_text(b.low, decimals_of(b.high - b.low)), number_text(b.high, decimals_of(b.high - b.low))};
    const std::vector<std::string> rest = measures(b);
    row.insert(row.end(), rest.begin(), rest.end());
    t.rows.push_back(std::move(row));
  }
  page_.table(t);
}

void Maker::residuals() {
  page_.section("Residuals");
  page_.paragraph(
      "A group is the returns of one line on one tie plane. Its mean distance from the plane, towards the scanner, is what the adjustment "
      "makes "
      "small: before with the start values, after with the result. A slope over scan angle, range or time that is left tells of an error "
      "that "
      "the model does not hold.");
  Table total{"residuals", "All groups", {}, {measures(residual_total(adjustment_))}, {}};
  total.columns.assign(measure_columns().begin(), measure_columns().end());
  page_.table(total);
  struct View {
    BinBy by;
    const char *name, *heading, *id, *caption, *unit;
  };
  for (const View& v :
       {View{BinBy::line, "residuals_line", "By line", "residuals-by-line", "Residuals by flight line", ""},
        View{BinBy::angle, "residuals_angle", "By scan angle", "residuals-by-angle", "Residuals by scan angle", "deg"},
        View{BinBy::range, "residuals_range", "By range", "residuals-by-range", "Residuals by range", "m"},
        View{BinBy::time, "residuals_time", "By time", "residuals-by-time", "Residuals by time since the first return", "s"}}) {
    page_.section(v.heading, 3);
    residual_table(v.by, v.id, v.caption, v.unit);
    figure(v.name, residual_chart(report_, v.by), std::string(v.caption) + ", one dot per group, by line colour (residuals.csv).");
  }
}

void Maker::outliers() {
  page_.section("Outliers");
  std::vector<size_t> out;
  for (size_t k = 0; k < adjustment_.groups.size(); ++k)
    if (adjustment_.groups[k].rejected) out.push_back(k);
  if (out.empty()) {
    page_.paragraph("No group of returns was taken out.");
    return;
  }
  std::stable_sort(out.begin(), out.end(),
                   [&](size_t a, size_t b) { return std::abs(adjustment_.groups[a].w) > std::abs(adjustment_.groups[b].w); });
  page_.paragraph("Groups that contradict the others and were taken out, the worst first. All of them are marked in residuals.csv.");
  out.resize(std::min(out.size(), most_outliers));
  Table t{"outliers", "Groups taken out", {}, {}, {}};
  t.columns = {{"plane"},     {"kind", false}, {"line"},       {"returns"},    {"time (s)"}, {"scan angle (deg)"},
               {"range (m)"}, {"before (cm)"}, {"after (cm)"}, {"redundancy"}, {"w"}};
  for (const size_t k : out) {
    const calib::GroupResidual& g = adjustment_.groups[k];
    t.rows.push_back({std::to_string(g.plane), std::string(calib::name_of(report_.ties.planes[g.plane].kind)),
                      std::to_string(report_.ties.lines[g.line].id), count_text(g.returns),
                      number_text(bin_value(g, report_.ties, BinBy::time), 1), number_text(core::to_degrees(g.angle), 1),
                      number_text(g.range, 0), number_text(g.before / centimetre, 2), number_text(g.after / centimetre, 2),
                      number_text(g.redundancy, 2), number_text(g.w, 1)});
  }
  page_.table(t);
}

void Maker::control_table(const char* id, const char* caption, const std::vector<calib::ControlResidual>& rows) {
  if (rows.empty()) return;
  Table t{id, caption, {}, {}, {}};
  t.columns = {{"point", false}, {"plane"}, {"residual (cm)"}, {"sigma (cm)"}, {"redundancy"}, {"w"}, {"outcome", false}};
  for (const calib::ControlResidual& c : rows) {
    t.rows.push_back({c.name, std::to_string(c.plane), number_text(c.residual / centimetre, 2), number_text(c.sigma / centimetre, 2),
                      number_text(c.redundancy, 2), number_text(c.w, 1), c.rejected ? "taken out" : "used"});
    t.tones.push_back(c.rejected ? Tone::caution : Tone::plain);
  }
  page_.table(t);
}

void Maker::control() {
  page_.section("Surveyed points");
  if (adjustment_.control.empty() && report_.checks.empty()) {
    page_.paragraph("No surveyed point took part: heights and positions are those of the trajectory.");
    return;
  }
  control_table("control", "Points that took part: distance from the adjusted plane they lie on, along its normal", adjustment_.control);
  if (report_.checks.empty()) return;
  Table t{"checks", "Check points, which took no part: height of the returns around a point minus that of the point", {}, {}, {}};
  t.columns = {{"point", false}, {"difference (cm)"}, {"sigma (cm)"}, {"difference / sigma"}};
  for (const calib::ControlResidual& c : report_.checks)
    t.rows.push_back({c.name, number_text(c.residual / centimetre, 2), number_text(c.sigma / centimetre, 2), number_text(c.w, 1)});
  page_.table(t);
}

void Maker::corrections() {
  const auto chart = correction_chart(report_);
  if (!chart) return;
  page_.section("Corrections of the lines");
  page_.paragraph("What each line's trajectory was moved and turned by, to be added to it; linear in time between the knots.");
  Table t{"corrections", "Largest correction of each line, over its knots", {}, {}, {}};
  t.columns = {{"line"},      {"knots"},         {"north (cm)"},     {"east (cm)"},
               {"down (cm)"}, {"roll (arcsec)"}, {"pitch (arcsec)"}, {"heading (arcsec)"}};
  for (const calib::LineCorrection& c : adjustment_.corrections) {
    std::vector<std::string> row{std::to_string(c.line), count_text(c.value.size())};
    for (size_t axis = 0; axis < 6; ++axis) {
      double largest = 0.0;
      for (const auto& v : c.value)
        if (std::abs(v[axis]) > std::abs(largest)) largest = v[axis];
      row.push_back(number_text(largest / (axis < 3 ? centimetre : arc_second), axis < 3 ? 2 : 1));
    }
    t.rows.push_back(std::move(row));
  }
  page_.table(t);
  figure("corrections", *chart, "Corrections over time, with one sigma to both sides (corrections.csv).");
}

void Maker::sections() {
  if (report_.sections.empty()) return;
  page_.section("Cross-sections");
  page_.paragraph("Returns near a vertical cut, by line colour. Before, the lines stand apart; after, they should lie on one another.");
  Table t{"sections", "Cross-sections", {}, {}, {}};
  t.columns = {{"section", false}, {"width (m)"}, {"length (m)"}, {"lines"}, {"returns before"}, {"returns after"}};
  for (const CrossSection& s : report_.sections) {
    const auto returns = [](const std::vector<SectionPoints>& lines) {
      return std::accumulate(lines.begin(), lines.end(), std::uint64_t{0},
                             [](std::uint64_t n, const SectionPoints& p) { return n + p.along.size(); });
    };
    t.rows.push_back({s.name, number_text(s.width, 2), number_text((s.ends[1] - s.ends[0]).norm(), 1), count_text(s.after.size()),
                      count_text(returns(s.before)), count_text(returns(s.after))});
  }
  page_.table(t);
  for (size_t k = 0; k < report_.sections.size(); ++k)
    figure("section_" + std::to_string(k + 1), section_chart(report_, report_.sections[k]),
           "Cross-section “" + report_.sections[k].name + "” before and after (sections.csv).");
}

void Maker::differences() {
  if (report_.differences.empty()) return;
  page_.section("Differences between lines");
  page_.paragraph("Heights of one line minus heights of the other where both have smooth ground.");
  Table t{"differences", "Height differences of overlapping lines, before and after", {}, {}, {}};
  t.columns = {{"line"}, {"minus line"}};
  for (const char* state : {"before", "after"})
    for (const char* measure : {"cells", "mean", "rms", "95 % within"})
      t.columns.push_back({std::string(measure) +
                           (measure == std::string_view("cells") ? std::string(", ") + state : std::string(", ") + state + " (cm)")});
  std::vector<std::pair<double, size_t>> worst;
  for (size_t k = 0; k < report_.differences.size(); ++k) {
    const LineDifference& d = report_.differences[k];
    std::vector<std::string> row{std::to_string(d.line_a), std::to_string(d.line_b)};
    for (const core::Grid* g : {&d.before, &d.after}) {
      const report::Statistics s = difference_statistics(*g);
      row.push_back(count_text(s.n));
      for (const double v : {s.mean, s.rms, s.q95}) row.push_back(number_text(v / centimetre, 2));
      if (g == &d.after) worst.emplace_back(std::isfinite(s.rms) ? -s.rms : 0.0, k);
    }
    t.rows.push_back(std::move(row));
  }
  page_.table(t);
  std::stable_sort(worst.begin(), worst.end());
  std::vector<size_t> shown;
  for (size_t k = 0; k < std::min(worst.size(), most_maps); ++k) shown.push_back(worst[k].second);
  std::sort(shown.begin(), shown.end());
  if (shown.size() < worst.size())
    page_.paragraph("Maps of the pairs with the largest differences left; those of the others are in the folder figures.");
  for (size_t k = 0; k < report_.differences.size(); ++k)
    for (const bool before : {true, false}) {
      const LineDifference& d = report_.differences[k];
      const core::Picture picture = difference_map(d, before);
      if (picture.width == 0) continue;
      const std::string pair = std::to_string(d.line_a) + "_" + std::to_string(d.line_b);
      const std::string file = "figures/difference_" + pair + (before ? "_before.png" : "_after.png");
      const std::string png = keep_(file, picture);
      if (std::find(shown.begin(), shown.end(), k) == shown.end()) continue;
      page_.figure_png(png,
                       "Line " + std::to_string(d.line_a) + " minus line " + std::to_string(d.line_b) + (before ? ", before" : ", after") +
                           " (" + difference_file(d, before) + "). Mind the range of the colours, which the legend states.",
                       file);
    }
}

void Maker::files() {
  page_.section("Files beside this report");
  std::vector<std::string> items{
      report_.strips ? "strips.json: everything in this report."
                     : "calibration.json: the values for the survey's run, and everything in this report.",
      "residuals.csv: each group of returns. planes.csv: each tie plane. corrections.csv: each line's corrections.",
  };
  if (!report_.sections.empty()) items.emplace_back("sections.csv: the returns of the cross-sections.");
  if (!report_.differences.empty()) items.emplace_back("differences: height differences as GeoTIFF.");
  items.emplace_back("figures: every drawing as PNG.");
  page_.list(items);
}

}  // namespace

std::string calibration_page(const CalibrationReport& report, const KeepFigure& keep) { return Maker(report, keep).html(); }

}  // namespace swath::stages
