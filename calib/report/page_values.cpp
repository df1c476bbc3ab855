// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/page_values.h"

#include <algorithm>
#include <array>

#include "calib/report/figures.h"
#include "calib/report/verdict.h"
#include "calib/report_units.h"
#include "core/config/units.h"
#include "report/html.h"

namespace swath::calib {
namespace {

using calib::Estimate;
using calib::Parameter;
using report::count_text;
using report::number_text;
using report::Table;
using report::Tone;

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

std::string outcome(const Estimate& e, bool delivered) {
  if (!delivered) return e.grade == calib::Grade::unsettled ? "not settled" : "not determined";
  if (e.grade == calib::Grade::undetermined) return "delivered, mostly its start value";
  return e.grade == calib::Grade::coarse ? "delivered, coarse" : "delivered";
}

/// `notes`: of the sigmas, which are as many as these.
void value_table(const PageParts& parts, const Group& g, const std::vector<std::string>& notes) {
  Table t{g.id, g.title, {}, {}, {}};
  t.columns = {{"parameter", false}, {headed("nominal", g.value_unit)}, {headed("value", g.value_unit)}, {headed("change", g.change_unit)}};
  static constexpr std::array<const char*, 5> sigmas{"sigma", "formal", "jackknife, lines", "jackknife, planes", "white"};
  for (size_t k = 0; k < notes.size(); ++k) t.columns.push_back({headed(sigmas[k], g.change_unit) + notes[k]});
  t.columns.push_back({"from the data (%)"});
  t.columns.push_back({"outcome", false});
  bool any = false;
  for (const Parameter p : g.parameters) {
    const Estimate& e = parts.report.adjustment.estimates[static_cast<size_t>(p)];
    if (!e.estimated) continue;
    any = true;
    const auto shown = [&](double v) { return number_text((v - g.from) / g.value_size, g.value_decimals); };
    std::vector<std::string> row{unbroken(words_of(p).name), shown(e.start)};
    const bool good = is_delivered(parts.report.adjustment, p);
    const double none = calib::not_known;
    const bool known = good || e.found_sigma > 0.0;
    const double value = good ? e.value : e.found;
    row.push_back(shown(known ? value : none));
    const std::array<double, 6> numbers{value - e.start, good ? e.sigma : e.found_sigma, e.formal, e.jackknife_lines, e.jackknife_planes,
                                        e.white};
    for (size_t k = 0; k <= notes.size(); ++k) row.push_back(number_text(known ? numbers[k] / g.change_size : none, g.change_decimals));
    row.push_back(number_text(known ? 100.0 * e.determined : none, 1));
    row.push_back(outcome(e, good));
    t.rows.push_back(std::move(row));
    t.tones.push_back(good ? Tone::plain : Tone::bad);
  }
  if (any) parts.page.table(t);
}

std::vector<std::string> sigma_notes(const PageParts& parts) {
  return {
      parts.page.footnote("The one-sigma uncertainty that is delivered in calibration.json: the larger of the formal one and the lines' "
                          "jackknife (of four lines or more), with "
                          "what the stated sigmas of values that were held (the lever arm) do to it."),
      parts.page.footnote("From the adjustment's covariance, with the trajectory's errors correlated in time."),
      parts.page.footnote("How far the values scatter when one flight line at a time is left out."),
      parts.page.footnote("How far they scatter when one region of tie planes at a time is left out."),
      parts.page.footnote(
          "What the sigma would be if every return were independent and the trajectory without error. For comparison only: it is "
          "far too small, since neighbouring returns share the trajectory's errors.")};
}

std::vector<std::string> joint_note(const PageParts& parts) {
  return {
      parts.page.footnote("One standard deviation by the covariance of the joint adjustment, in which the trajectory is unknown; it is "
                          "delivered in calibration.json. Values that are held count as free of error.")};
}

}  // namespace

void add_values(const PageParts& parts) {
  parts.page.section("Calibration values");
  const bool joint = parts.report.joint;
  const std::vector<std::string> notes = joint ? joint_note(parts) : sigma_notes(parts);
  for (const Group& g : value_groups()) value_table(parts, g, notes);
  std::vector<std::string> held;
  for (int k = 0; k < estimated_count; ++k)
    if (!parts.report.adjustment.estimates[static_cast<size_t>(k)].estimated) held.emplace_back(words_of(parameter_at(k)).name);
  if (!held.empty()) parts.page.paragraph("Held at the start value and not estimated: " + joined(held) + ".");
  parts.page.paragraph(
      std::string(
          "“From the data” is the share of the knowledge that this flight brought, the rest being the start value with its a-priori "
          "sigma. calibration.json ") +
      (joint ? "has all values that were estimated, also those that are mostly their start value."
             : "keeps the start value of what is not determined or not settled; the value found is listed here and in its estimates."));
}

void add_plane_differences(const PageParts& parts) {
  parts.page.section("How the lines meet");
  parts.page.paragraph(
      "Two lines that have seen the same plane: the difference of the mean distances of their returns from it, over all planes that the "
      "two "
      "share. " +
      (parts.report.joint ? std::string("Before: with the smoother's trajectory and the start values. After: with the adjusted one.")
                          : "Before: with the trajectory as it was given. After: with the corrected one. The calibration was held."));
  Table t{"plane-differences", "Differences of lines on common planes", {}, {}, {}};
  t.columns = {{"line"}, {"and line"}, {"planes"}, {"mean before (cm)"}, {"rms before (cm)"}, {"mean after (cm)"}, {"rms after (cm)"}};
  const auto add = [&](const calib::PairOnPlanes& p, std::string a, std::string b) {
    t.rows.push_back({std::move(a), std::move(b), count_text(p.planes), number_text(p.mean_before / centimetre, 2),
                      number_text(p.rms_before / centimetre, 2), number_text(p.mean_after / centimetre, 2),
                      number_text(p.rms_after / centimetre, 2)});
  };
  for (const calib::PairOnPlanes& p : parts.report.strips->pairs) add(p, std::to_string(p.line_a), std::to_string(p.line_b));
  add(parts.report.strips->all, "all", "all");
  parts.page.table(t);
}

void add_summary(const PageParts& parts) {
  Table t{"adjustment", "The adjustment", {{"figure", false}, {"value"}}, {}, {}};
  t.rows = {{"observations", count_text(parts.report.adjustment.observations)},
            {"unknowns", count_text(parts.report.adjustment.unknowns)},
            {"sigma of unit weight", number_text(parts.report.adjustment.sigma0, 3)}};
  if (!parts.report.strips)
    t.rows.push_back({"condition number of the scaled normal matrix", number_text(parts.report.adjustment.condition, 1)});
  t.rows.insert(t.rows.end(), {{"iterations", count_text(static_cast<std::uint64_t>(std::max(parts.report.adjustment.iterations, 0)))},
                               {"returns taken out", count_text(parts.report.adjustment.rejected_returns)}});
  parts.page.table(t);

  if (!parts.report.adjustment.components.empty()) {
    Table c{"components", "How large the errors of the observations are: stated, and as the adjustment found them", {}, {}, {}};
    c.columns = {{"observations", false}, {"stated sigma"}, {"unit", false}, {"found / stated"}, {"redundancy"}, {"outcome", false}};
    for (const calib::VarianceComponent& v : parts.report.adjustment.components) {
      const bool angle = v.name.find("angle") != std::string::npos || v.name.find("attitude") != std::string::npos;
      c.rows.push_back({v.name, number_text(v.stated / (angle ? arc_second : centimetre), 2), angle ? "arcsec" : "cm",
                        number_text(v.factor, 2), number_text(v.redundancy, 1), v.estimated ? "estimated" : "kept as stated"});
    }
    parts.page.table(c);
  }
}

void add_correlations(const PageParts& parts) {
  const auto chart = correlation_chart(parts.report);
  if (!chart) return;
  parts.page.section("Correlations", 3);
  parts.page.paragraph(
      "Near one or minus one the two parameters can hardly be separated on this flight: an error of the one is compensated by the other.");
  parts.keep("figures/correlation.png", report::draw(*chart));
  parts.page.figure_svg(report::svg(*chart), "Correlations between the estimated parameters.", "figures/correlation.png");
}

}  // namespace swath::calib
