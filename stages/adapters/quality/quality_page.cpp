// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "report/html.h"
#include "stages/adapters/quality/quality_facts.h"
#include "stages/adapters/quality/quality_tables.h"

namespace swath::stages {
namespace {

using report::number_text;
using report::Tone;
using report::value_table;

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
  page.table(value_table(
      "First returns in cells of " + text("cell_m", 1) + " m, without the rims of swaths and holes.",
      {{"area (km2)", text("area_km2", 3)},
       {"first returns", report::count_text(static_cast<std::uint64_t>(std::max(0.0, f.density.known("pulses").value_or(0.0))))},
       {"per m2, all lines (ANPD)", text("density", 2)},
       {"spacing, all lines (m, ANPS)", text("spacing_m", 3)},
       {"per m2, sparsest line (NPD)", text("single_density", 2)},
       {"5 %, 50 %, 95 % of the cells have less per m2",
        text("density_5", 2) + ", " + text("density_50", 2) + ", " + text("density_95", 2)}}));
  page.table(fact_table("Each flight line by itself.",
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
  page.table(value_table("By a pulse spacing of " + text("anps_m", 3) + " m (" + f.swath.text("anps_from") + ").",
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
    page.table(fact_table("Pairs on smooth cells of " + cell +
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
  page.table(fact_table(
      "Each line by itself on those cells: scatter of a return about the plane of its cell; the smoothest quarter are roads, car "
      "parks and roofs.",
      {{"line", "line", 0},
       {"smooth cells", "smooth_cells", 0},
       {"scatter (cm)", "repeatability_m", 2, 100},
       {"smoothest quarter (cm)", "hard_m", 2, 100},
       {"cells with a first return (%)", "even", 1, 100}},
      f.swath.list("lines")));
  if (std::vector<Facts> offsets = f.lines.list("lines"); !offsets.empty())
    page.table(fact_table("Height of each line over the mean of those that it overlaps, by least squares (quality.lines).",
                          {{"line", "line", 0},
                           {"group", "group", 0},
                           {"overlaps", "overlaps", 0},
                           {"height (cm)", "offset_m", 2, 100},
                           {"sigma (cm)", "sigma_m", 2, 100}},
                          offsets));
  add_map(page, f.overlap_map, "Largest difference of two lines, lower line number minus higher; steep cells, too.");
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
  add_check_points(page, f);
  add_roofs(page, f);
  add_surface(page, f);
  if (!f.not_judged.empty()) {
    page.section("What is not shown");
    page.list(f.not_judged);
  }
  return page;
}

}  // namespace swath::stages
