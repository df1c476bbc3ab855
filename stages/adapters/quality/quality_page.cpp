// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "report/html.h"
#include "stages/adapters/quality/quality_facts.h"

namespace swath::stages {
namespace {

using report::number_text;
using report::Tone;

/// A column of a table of facts: its head, the key, and decimals (below 0: a text; 0 and more: a number).
struct FactColumn {
  std::string head, key;
  int decimals = 3;
  double scale = 1.0;
};

report::Table table_of(const std::string& caption, const std::vector<FactColumn>& columns, const std::vector<Facts>& rows) {
  report::Table t;
  t.caption = caption;
  for (const FactColumn& c : columns) t.columns.push_back({c.head, c.decimals >= 0});
  for (const Facts& row : rows) {
    std::vector<std::string> cells;
    for (const FactColumn& c : columns)
      cells.push_back(c.decimals < 0 ? row.text(c.key) : number_text(c.scale * row.number(c.key), c.decimals));
    t.rows.push_back(std::move(cells));
  }
  return t;
}

report::Table figures(const std::string& caption, const std::vector<std::pair<std::string, std::string>>& rows) {
  report::Table t;
  t.caption = caption;
  t.columns = {{"", false}, {"value"}};
  for (const auto& [name, value] : rows) t.rows.push_back({name, value});
  return t;
}

void add_map(QualitySheet& page, const std::filesystem::path& file, const std::string& caption) {
  if (!file.empty()) page.map(file, caption);
}

/// Bins of equal width as columns.
void add_histogram(QualitySheet& page, const Facts& from, const std::string& x_label, const std::string& caption) {
  const std::vector<double> middles = from.numbers("bins_m"), cells = from.numbers("bin_cells");
  if (middles.size() < 3) return;
  double width = middles[1] - middles[0];
  for (size_t k = 2; k < middles.size(); ++k) width = std::min(width, middles[k] - middles[k - 1]);
  report::Series s;
  s.mark = report::Mark::band;
  const auto add = [&s](double x, double y) {
    s.x.push_back(100.0 * x);
    s.y.push_back(y);
    s.y2.push_back(0.0);
  };
  const double edge = 0.03 * width;  // steep, for a band has one height at each place
  for (size_t k = 0; k < middles.size(); ++k) {
    const double left = middles[k] - 0.5 * width, right = middles[k] + 0.5 * width;
    if (k == 0 || middles[k] - middles[k - 1] > 1.5 * width) add(left - edge, 0.0);
    add(left + edge, cells[k]);
    add(right - edge, cells[k]);
    if (k + 1 == middles.size() || middles[k + 1] - middles[k] > 1.5 * width) add(right + edge, 0.0);
  }
  report::Panel panel;
  panel.x_label = x_label;
  panel.y_label = "cells";
  panel.series = {s};
  report::Chart chart;
  chart.panels.push_back(panel);
  page.chart(std::move(chart), caption);
}

void add_requirements(QualitySheet& page, const QualityFacts& f) {
  if (f.requirements.empty()) return;
  page.section("Requirements");
  page.paragraph(f.level == "none"
                     ? std::string("The limits that the config states.")
                     : "Quality level " + f.level +
                           " of the USGS Lidar Base Specification 2025 rev. A; limits that the config states take the level's place.");
  report::Table t;
  t.id = "requirements";
  t.caption = "Requirements and what was measured.";
  t.columns = {{"requirement", false}, {"measured"}, {"limit"}, {"unit", false}, {"", false}};
  for (const quality::Requirement& r : f.requirements) {
    const int decimals = r.unit == "m2" ? 1 : 3;
    t.rows.push_back({r.what, r.value ? number_text(*r.value, decimals) : "",
                      (r.is_least ? "at least " : "at most ") + number_text(r.limit, decimals), r.unit,
                      !r.value     ? "not judged"
                      : r.is_met() ? "met"
                                   : "missed"});
    t.tones.push_back(!r.value ? Tone::caution : r.is_met() ? Tone::good : Tone::bad);
  }
  page.table(t);
}

void add_density(QualitySheet& page, const QualityFacts& f) {
  if (!f.density.any()) return;
  page.section("Density of first returns");
  const auto text = [&](const char* key, int decimals) { return number_text(f.density.number(key), decimals); };
  page.table(
      figures("First returns in cells of " + text("cell_m", 1) + " m, without the rims of swaths and holes.",
              {{"area (km2)", text("area_km2", 3)},
               {"first returns", report::count_text(static_cast<std::uint64_t>(std::max(0.0, f.density.known("pulses").value_or(0.0))))},
               {"per m2, all lines (ANPD)", text("density", 2)},
               {"spacing, all lines (m, ANPS)", text("spacing_m", 3)},
               {"per m2, sparsest line (NPD)", text("single_density", 2)},
               {"5 %, 50 %, 95 % of the cells have less per m2",
                text("density_5", 2) + ", " + text("density_50", 2) + ", " + text("density_95", 2)}}));
  page.table(table_of("Each flight line by itself.",
                      {{"line", "line", 0},
                       {"first returns", "pulses", 0},
                       {"area (km2)", "area_m2", 3, 1e-6},
                       {"per m2", "density", 2},
                       {"spacing (m)", "spacing_m", 3}},
                      f.density.list("lines")));
  add_map(page, f.density_map, "First returns per m2 of all lines.");
}

void add_voids(QualitySheet& page, const QualityFacts& f) {
  if (!f.swath.any()) return;
  page.section("Spatial distribution and voids");
  if (const std::string why = f.swath.text("no_voids"); !why.empty()) return page.paragraph("Not judged: " + why + ".");
  const auto text = [&](const char* key, int decimals, double scale = 1.0) { return number_text(scale * f.swath.number(key), decimals); };
  page.table(figures("By a pulse spacing of " + text("anps_m", 3) + " m (" + f.swath.text("anps_from") + ").",
                     {{"cells of twice the spacing with a first return (%)", text("even", 1, 100.0)},
                      {"area in which voids are looked for (km2)", text("judged_km2", 3)},
                      {"least area of a void (m2)", text("least_void_m2", 1)},
                      {"voids apart from water", text("voids", 0)},
                      {"their area (m2)", text("void_m2", 1)},
                      {"their share of the area (%)", text("void_share", 3, 100.0)},
                      {"voids that are water", text("water_voids", 0)},
                      {"their area (m2)", text("water_void_m2", 1)}}));
  if (std::vector<Facts> rows = f.swath.list("largest"); !rows.empty()) {
    report::Table t;
    t.caption = "The largest voids; all of them are in the layer voids of swath.gpkg.";
    t.columns = {{"easting (" + f.unit + ")"}, {"northing (" + f.unit + ")"}, {"area (m2)"}, {"", false}};
    for (const Facts& r : rows)
      t.rows.push_back({number_text(r.number("x") / f.metres, 1), number_text(r.number("y") / f.metres, 1),
                        number_text(r.number("area_m2"), 1), r.holds("water") ? "water" : "void"});
    page.table(t);
  }
  add_map(page, f.distribution_map, "Share of cells of twice the pulse spacing with a first return; outlines of voids, water or not.");
}

void add_overlaps(QualitySheet& page, const QualityFacts& f) {
  if (!f.swath.any()) return;
  page.section("Flight lines against one another");
  const std::string cell = number_text(f.swath.number("cell_m"), 1);
  if (f.swath.number("overlap_cells") > 0.0) {
    page.table(table_of("Pairs on smooth cells of " + cell +
                            " m up to 10 deg steep, line a minus line b. Error over sigma: rms over what the points' own sigmas predict.",
                        {{"a", "line_a", 0},
                         {"b", "line_b", 0},
                         {"cells", "cells", 0},
                         {"mean (cm)", "mean_m", 2, 100},
                         {"median (cm)", "median_m", 2, 100},
                         {"rms (cm)", "rms_m", 2, 100},
                         {"95 % (cm)", "q95_m", 2, 100},
                         {"predicted (cm)", "predicted_m", 2, 100},
                         {"error over sigma", "error_over_sigma", 2}},
                        f.swath.list("pairs")));
    add_histogram(page, f.swath, "difference (cm)", "Differences of all pairs, bins of 5 mm.");
  }
  page.table(
      table_of("Each line by itself on those cells: scatter of a return about the plane of its cell; the smoothest quarter are roads, car "
               "parks and roofs.",
               {{"line", "line", 0},
                {"smooth cells", "smooth_cells", 0},
                {"scatter (cm)", "repeatability_m", 2, 100},
                {"smoothest quarter (cm)", "hard_m", 2, 100},
                {"cells with a first return (%)", "even", 1, 100}},
               f.swath.list("lines")));
  if (std::vector<Facts> offsets = f.lines.list("lines"); !offsets.empty())
    page.table(table_of("Height of each line over the mean of those that it overlaps, by least squares (quality.lines).",
                        {{"line", "line", 0},
                         {"group", "group", 0},
                         {"overlaps", "overlaps", 0},
                         {"height (cm)", "offset_m", 2, 100},
                         {"sigma (cm)", "sigma_m", 2, 100}},
                        offsets));
  add_map(page, f.overlap_map, "Largest difference of two lines, lower line number minus higher; steep cells, too.");
}

/// Differences at the check points, in the order of the file.
void add_residuals(QualitySheet& page, const std::vector<Facts>& marks) {
  if (marks.size() < 2) return;
  report::Series points{"ground points", {}, {}, {}, report::Mark::dots, -1}, model{"terrain model", {}, {}, {}, report::Mark::dots, -1},
      sigma{"sigma of the points", {}, {}, {}, report::Mark::band, -1};
  bool has_sigma = false;
  for (size_t k = 0; k < marks.size(); ++k) {
    const auto x = static_cast<double>(k + 1);
    for (auto [series, key] : {std::pair(&points, "points_m"), std::pair(&model, "dtm_m"), std::pair(&sigma, "predicted_m")}) {
      series->x.push_back(x);
      series->y.push_back(100.0 * marks[k].number(key));
    }
    has_sigma = has_sigma || marks[k].number("predicted_m") > 0.0;
  }
  report::Panel panel;
  panel.x_label = "check point, in the order of the files";
  panel.y_label = "product less check point (cm)";
  panel.y_share = 0.98;
  if (has_sigma) panel.series.push_back(sigma);
  panel.series.push_back(points);
  panel.series.push_back(model);
  report::Chart chart;
  chart.panels.push_back(panel);
  page.chart(std::move(chart), "Differences at the check points.", "check_points.csv");
}

void add_points(QualitySheet& page, const QualityFacts& f) {
  if (!f.points.any()) return;
  page.section("Check points");
  std::vector<std::string> named;
  for (const Facts& one : f.points.list("named")) named.push_back(one.text("sentence"));
  if (!named.empty()) page.list(named);
  page.table(
      table_of("Product less check point. RMSE with marks: the check points' own error added (ASPRS 2024), on open ground the NVA, under "
               "vegetation the VVA.",
               {{"product", "product", -1},
                {"cover", "cover", -1},
                {"n", "n", 0},
                {"mean (cm)", "mean", 1, 100},
                {"sd (cm)", "std", 1, 100},
                {"rms (cm)", "rms", 1, 100},
                {"median (cm)", "median", 1, 100},
                {"NMAD (cm)", "nmad", 1, 100},
                {"90 % (cm)", "q90", 1, 100},
                {"95 % (cm)", "q95", 1, 100},
                {"RMSE with marks (cm)", "rmse_with_marks_m", 1, 100},
                {"error over sigma", "error_over_sigma", 2}},
               f.points.list("accuracy")));
  std::vector<std::string> few;
  for (const Facts& a : f.points.list("accuracy"))
    if (!a.holds("is_enough") && a.text("product") == "points") few.push_back(a.text("cover") + ": " + number_text(a.number("n"), 0));
  if (!few.empty()) {
    std::string list;
    for (const std::string& one : few) list += (list.empty() ? "" : ", ") + one;
    page.paragraph("Fewer than 30 check points make no statement of accuracy (ASPRS 2024): " + list + ".");
  }
  add_residuals(page, f.points.list("check_points_found"));
  if (std::vector<Facts> lines = f.points.list("lines"); !lines.empty())
    page.table(table_of("Flight lines against the check points that they show.",
                        {{"line", "line", 0},
                         {"check points", "marks", 0},
                         {"median difference (cm)", "difference_m", 1, 100},
                         {"sigma to be expected (cm)", "sigma_m", 1, 100}},
                        lines));
  const Facts map = f.points.table("map");
  if (!map.any()) return;
  page.section("Class of a map", 3);
  page.table(figures("By the rule \"" + map.text("rule") + "\".",
                     {{"standard error of heights (m)", number_text(map.number("ep_height_m"), 3)},
                      {"90 % of the height errors are smaller (m)", number_text(map.number("q90_height_m"), 3)},
                      {"class of heights", map.text("height_class")},
                      {"standard error of planimetry (m)", number_text(map.number("ep_plan_m"), 3)},
                      {"where it comes from", map.text("ep_plan_from")},
                      {"class of planimetry", map.text("plan_class")},
                      {"class of the map", map.text("class")},
                      {"C factor", number_text(map.number("c_factor"), 0)}}));
  page.table(table_of("Closest contour interval of each class.", {{"class", "class", -1}, {"interval (m)", "interval_m", 2}},
                      map.list("intervals")));
}

/// Where the cloud has each roof, from where it was surveyed.
void add_shifts(QualitySheet& page, const std::vector<Facts>& roofs, const Facts& mean) {
  report::Series each{"roofs", {}, {}, {}, report::Mark::dots, -1}, all{"mean", {}, {}, {}, report::Mark::dots, -1},
      surveyed{"as surveyed", {0.0}, {0.0}, {}, report::Mark::dots, -1};
  for (const Facts& r : roofs) {
    if (r.text("state") != "both") continue;
    each.x.push_back(100.0 * r.number("east_m")), each.y.push_back(100.0 * r.number("north_m"));
  }
  if (each.x.empty()) return;
  if (mean.known("east_m")) all.x.push_back(100.0 * mean.number("east_m")), all.y.push_back(100.0 * mean.number("north_m"));
  report::Chart chart;
  chart.width = 700, chart.panel_height = 420;
  chart.panels.resize(1);
  chart.panels[0].x_label = "east (cm)";
  chart.panels[0].y_label = "north (cm)";
  chart.panels[0].equal_scale = true;
  chart.panels[0].series = {each, all, surveyed};
  page.chart(std::move(chart), "Roofs of the cloud less their targets.", "report.json");
}

void add_planimetry(QualitySheet& page, const QualityFacts& f) {
  const Facts p = f.points.table("planimetry");
  if (!p.any()) return;
  page.section("Horizontal accuracy by roofs");
  const auto cm = [&](const char* key) { return number_text(100.0 * p.number(key), 1); };
  page.table(
      figures("Cloud less surveyed roofs, by the edges that end in the air. RMSE_H as ASPRS 2024 has it, with the targets' own error.",
              {{"roofs compared", number_text(p.number("roofs"), 0)},
               {"roofs that show one component", number_text(p.known("one_component").value_or(0.0), 0)},
               {"roofs that changed or contradict the others, left out", number_text(p.known("changed").value_or(0.0), 0)},
               {"mean east, sigma (cm)", cm("east_m") + ", " + cm("sigma_east_m")},
               {"mean north, sigma (cm)", cm("north_m") + ", " + cm("sigma_north_m")},
               {"RMSE east, north (cm)", cm("rmse_east_m") + ", " + cm("rmse_north_m")},
               {"RMSE, radial (cm)", cm("rmse_m")},
               {"of it by the spacing of the pulses (cm)", cm("measured_sigma_m")},
               {"sigma of the targets, radial (cm)", cm("sigma_of_targets_m")},
               {"RMSE_H (cm)", cm("rmse_with_targets_m")},
               {"95 % by the NSSDA (cm)", cm("nssda_m")}}));
  if (!p.holds("is_enough")) page.paragraph("Fewer than 30 roofs make no statement of horizontal accuracy (ASPRS 2024).");
  const std::vector<Facts> roofs = f.points.list("roofs");
  add_shifts(page, roofs, p);
  page.table(table_of("Each roof.",
                      {{"roof", "name", -1},
                       {"shows", "state", -1},
                       {"edges", "edges", 0},
                       {"pulses", "pulses", 0},
                       {"east (cm)", "east_m", 1, 100},
                       {"sigma (cm)", "sigma_east_m", 1, 100},
                       {"north (cm)", "north_m", 1, 100},
                       {"sigma (cm)", "sigma_north_m", 1, 100},
                       {"edges farther out by (cm)", "wider_m", 1, 100}},
                      roofs));
}

/// Heights of both models along a line, and their difference.
void add_profile(QualitySheet& page, const Facts& profile) {
  const std::vector<double> along = profile.numbers("along_m"), model = profile.numbers("model_m"),
                            reference = profile.numbers("reference_m");
  report::Series of_model{"terrain model", along, model, {}, report::Mark::line, -1},
      of_reference{"reference", along, reference, {}, report::Mark::line, -1}, difference{"", along, {}, {}, report::Mark::line, -1};
  bool any = false;
  for (size_t k = 0; k < along.size(); ++k) {
    difference.y.push_back(100.0 * (model[k] - reference[k]));
    any = any || std::isfinite(difference.y.back());
  }
  if (!any) return;
  report::Chart chart;
  chart.panels.resize(2);
  for (report::Panel& panel : chart.panels) panel.x_label = "along the line (m)";
  chart.panels[0].y_label = "height (m)";
  chart.panels[0].series = {of_reference, of_model};
  chart.panels[1].y_label = "model less reference (cm)";
  chart.panels[1].y_share = 0.98;
  chart.panels[1].series = {difference};
  page.chart(std::move(chart), "Section " + profile.text("name") + ".", "surface_profiles.csv");
}

void add_surface(QualitySheet& page, const QualityFacts& f) {
  if (!f.surface.any()) return;
  page.section("Terrain model against the reference");
  page.paragraph("Reference: " + f.surface.text("reference") + "." +
                 (f.surface.text("heights").empty() ? "" : " Heights: " + f.surface.text("heights") + "."));
  page.table(table_of("Terrain model less reference, by slope and cover.",
                      {{"slope (deg)", "slope", -1},
                       {"cover", "cover", -1},
                       {"cells", "n", 0},
                       {"mean (cm)", "mean_m", 1, 100},
                       {"sd (cm)", "std_m", 1, 100},
                       {"rms (cm)", "rms_m", 1, 100},
                       {"median (cm)", "median_m", 1, 100},
                       {"NMAD (cm)", "nmad_m", 1, 100},
                       {"68 % (cm)", "q68_m", 1, 100},
                       {"90 % (cm)", "q90_m", 1, 100},
                       {"95 % (cm)", "q95_m", 1, 100}},
                      f.surface.list("classes")));
  add_histogram(page, f.surface, "terrain model less reference (cm)", "All differences; the outermost bins hold what lies beyond.");
  add_map(page, f.surface_map, "Terrain model less reference.");
  for (const Facts& profile : f.surface.list("profiles")) add_profile(page, profile);
}

void add_verdict(QualitySheet& page, const QualityFacts& f) {
  const size_t missed = f.missed(), judged = f.judged(), named = f.points.list("named").size();
  const std::string faults =
      named == 0 ? "" : " " + std::to_string(named) + (named == 1 ? " fault is" : " faults are") + " named at the check points.";
  if (missed > 0)
    page.banner(Tone::bad, std::to_string(missed) + " of " + std::to_string(judged) + " judged requirements are missed." + faults);
  else if (f.requirements.empty())
    page.banner(named == 0 ? Tone::plain : Tone::caution, "No quality level is asked for: figures without a verdict." + faults);
  else
    page.banner(named == 0 && judged == f.requirements.size() ? Tone::good : Tone::caution,
                std::to_string(judged) + " of " + std::to_string(f.requirements.size()) +
                    " requirements are judged, and all of these are met." + faults);
}

}  // namespace

QualitySheet quality_page(const QualityFacts& f) {
  QualitySheet page("Quality of " + f.survey, f.crs + (f.heights.empty() ? "" : "; heights: " + f.heights));
  add_verdict(page, f);
  add_requirements(page, f);
  add_density(page, f);
  add_voids(page, f);
  add_overlaps(page, f);
  add_points(page, f);
  add_planimetry(page, f);
  add_surface(page, f);
  if (!f.not_judged.empty()) {
    page.section("What is not shown");
    page.list(f.not_judged);
  }
  return page;
}

}  // namespace swath::stages
