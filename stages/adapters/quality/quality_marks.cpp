// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "stages/adapters/quality/quality_tables.h"

namespace swath::stages {
namespace {

using report::number_text;
using report::value_table;

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

}  // namespace

void add_check_points(QualitySheet& page, const QualityFacts& f) {
  if (!f.points.any()) return;
  page.section("Check points");
  std::vector<std::string> named;
  for (const Facts& one : f.points.list("named")) named.push_back(one.text("sentence"));
  if (!named.empty()) page.list(named);
  page.table(
      fact_table("Product less check point. RMSE with marks: the check points' own error added (ASPRS 2024), on open ground the NVA, under "
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
    page.table(fact_table("Flight lines against the check points that they show.",
                          {{"line", "line", 0},
                           {"check points", "marks", 0},
                           {"median difference (cm)", "difference_m", 1, 100},
                           {"sigma to be expected (cm)", "sigma_m", 1, 100}},
                          lines));
  const Facts map = f.points.table("map");
  if (!map.any()) return;
  page.section("Class of a map", 3);
  page.table(value_table("By the rule \"" + map.text("rule") + "\".",
                         {{"standard error of heights (m)", number_text(map.number("ep_height_m"), 3)},
                          {"90 % of the height errors are smaller (m)", number_text(map.number("q90_height_m"), 3)},
                          {"class of heights", map.text("height_class")},
                          {"standard error of planimetry (m)", number_text(map.number("ep_plan_m"), 3)},
                          {"where it comes from", map.text("ep_plan_from")},
                          {"class of planimetry", map.text("plan_class")},
                          {"class of the map", map.text("class")},
                          {"C factor", number_text(map.number("c_factor"), 0)}}));
  page.table(fact_table("Closest contour interval of each class.", {{"class", "class", -1}, {"interval (m)", "interval_m", 2}},
                        map.list("intervals")));
}

void add_roofs(QualitySheet& page, const QualityFacts& f) {
  const Facts p = f.points.table("planimetry");
  if (!p.any()) return;
  page.section("Horizontal accuracy by roofs");
  const auto cm = [&](const char* key) { return number_text(100.0 * p.number(key), 1); };
  page.table(
      value_table("Cloud less surveyed roofs, by the edges that end in the air. RMSE_H as ASPRS 2024 has it, with the targets' own error.",
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
  page.table(fact_table("Each roof.",
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

void add_surface(QualitySheet& page, const QualityFacts& f) {
  if (!f.surface.any()) return;
  page.section("Terrain model against the reference");
  page.paragraph("Reference: " + f.surface.text("reference") + "." +
                 (f.surface.text("heights").empty() ? "" : " Heights: " + f.surface.text("heights") + "."));
  page.table(fact_table("Terrain model less reference, by slope and cover.",
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

}  // namespace swath::stages
