// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/flight_plan/plan_page.h"

#include <algorithm>
#include <cmath>

#include "core/config/units.h"
#include "io/raster/png.h"
#include "report/chart.h"
#include "report/html.h"
#include "report/page.h"
#include "report/value_map.h"

namespace swath::pipeline {
namespace {

using report::number_text;
using report::value_table;

void add_figures(report::Page& page, const planning::FlightPlan& p) {
  const planning::SwathFound& s = p.swath;
  std::vector<std::pair<std::string, std::string>> rows{
      {"area (km2)", number_text(1e-6 * p.area, 3)},
      {"lines", report::count_text(p.lines.size())},
      {"length of all lines (km)", number_text(1e-3 * p.line_length, 1)},
      {"time with turns (min)", number_text(p.seconds / 60, 1)},
      {"direction (deg)", number_text(core::to_degrees(p.direction), 1)},
      {"mean height above the ground (m)", number_text(s.height, 0)},
      {"width of the swath (m)", number_text(s.width, 0)},
      {"footprint of the beam (m)", number_text(s.footprint, 2)},
      {"spacing across / along (m)", number_text(s.across, 2) + " / " + number_text(s.along, 2)},
      {"pulses per m2 of one swath", number_text(s.density, 2)},
      {"spacing on the ground, with penetration (m)", number_text(s.ground_spacing, 2)},
      {"pulses in the air at a time", number_text(s.pulses_in_air, 2)}};
  if (p.least_overlap) rows.push_back({"least overlap (%)", number_text(100 * *p.least_overlap, 1)});
  page.table(value_table("The flight in figures, the swath over level ground at the mean height.", rows));
  report::Table t;
  t.caption = "Distribution over the cells of the area.";
  t.columns = {{"", false}, {"least"}, {"5 %"}, {"median"}, {"mean"}, {"95 %"}, {"greatest"}};
  const auto row = [&t](const std::string& name, const planning::Spread& v, int decimals) {
    std::vector<std::string> cells{name};
    for (const double x : {v.least, v.low, v.median, v.mean, v.high, v.greatest}) cells.push_back(number_text(x, decimals));
    t.rows.push_back(cells);
  };
  row("pulses per m2", p.density, 2);
  row("lines that see a cell", p.seen, 2);
  row("sigma of the ground's height (m)", p.sigma_height, 3);
  row("radial sigma of the place (m)", p.sigma_horizontal, 3);
  page.table(t);
}

void add_maps(report::Page& page, const planning::FlightPlan& p, const PlanInput& in) {
  std::vector<report::MapLine> lines;
  for (planning::Ring ring : in.area) {
    report::MapLine outline;
    ring.push_back(ring.front());
    for (const Eigen::Vector2d& v : ring) {
      outline.x.push_back(v.x());
      outline.y.push_back(v.y());
    }
    outline.width = 1.0;
    lines.push_back(outline);
  }
  for (const planning::LineFound& l : p.lines)
    lines.push_back({{l.line.from.x(), l.line.to.x()}, {l.line.from.y(), l.line.to.y()}, 1.5, p.lines.size() > 30 ? "" : l.line.name});
  const auto add = [&](const std::vector<float>& values, const std::string& title, const std::string& unit, const std::string& file) {
    report::ValueMapOptions o;
    o.title = title;
    o.value_unit = unit;
    page.figure_png(io::png_bytes(report::draw(report::value_map(p.coverage.lattice, values, lines, o))),
                    title + ", cells of " + number_text(p.coverage.lattice.cell, p.coverage.lattice.cell < 1 ? 2 : 0) + " m.", file);
  };
  add(p.coverage.density, "Pulses per m2 of all lines", "per m2", "density.tif");
  add(p.coverage.lines, "Lines that see a cell", "", "lines_seen.tif");
  std::vector<float> centimetres = p.coverage.sigma_height;
  for (float& v : centimetres) v *= 100.0f;
  add(centimetres, "Sigma of the ground's height by one point", "cm", "sigma.tif");
}

void add_lines(report::Page& page, const planning::FlightPlan& p) {
  report::Table t;
  t.id = "lines";
  t.caption = "Lines in the order of the flight; height in the height system of the terrain model.";
  t.columns = {{"line", false}, {"course (deg)"}, {"length (m)"}, {"height (m)"},      {"above ground least (m)"},
               {"mean (m)"},    {"greatest (m)"}, {"time (s)"},   {"turn before (s)"}, {"to the base (km)"}};
  report::Panel panel;
  panel.x_label = "line";
  panel.y_label = "height above the ground (m)";
  report::Series least{"least", {}, {}, {}, report::Mark::line, -1}, mean{"mean", {}, {}, {}, report::Mark::line, -1},
      greatest{"greatest", {}, {}, {}, report::Mark::line, -1};
  for (size_t k = 0; k < p.lines.size(); ++k) {
    const planning::LineFound& l = p.lines[k];
    t.rows.push_back({l.line.name, number_text(core::to_degrees(l.line.course()), 1), number_text(l.line.length(), 0),
                      number_text(l.line.level, 0), number_text(l.lowest, 0), number_text(l.mean, 0), number_text(l.highest, 0),
                      number_text(l.seconds, 0), number_text(l.turn_seconds, 0),
                      l.base_distance ? number_text(1e-3 * *l.base_distance, 1) : ""});
    const auto x = static_cast<double>(k + 1);
    for (auto [series, value] : {std::pair(&least, l.lowest), std::pair(&mean, l.mean), std::pair(&greatest, l.highest)}) {
      series->x.push_back(x);
      series->y.push_back(value);
    }
  }
  page.table(t);
  if (p.lines.size() < 2) return;
  panel.series = {least, mean, greatest};
  report::Chart chart;
  chart.panels.push_back(panel);
  page.figure_svg(report::svg(chart), "Height of each line above the ground below it.");
}

void add_budget(report::Page& page, const planning::FlightPlan& p) {
  for (const planning::BudgetFound& b : p.budget) {
    report::Table t;
    t.caption = "Errors of a point at a scan angle of " + number_text(core::to_degrees(b.angle), 1) + " deg, " + number_text(b.height, 0) +
                " m above the ground (cm).";
    t.columns = {{"source", false}, {"along track"}, {"across"}, {"up"}};
    const auto row = [&t](const std::string& name, const Eigen::Vector3d& e) {
      t.rows.push_back({name, number_text(100 * e.x(), 1), number_text(100 * e.y(), 1), number_text(100 * e.z(), 1)});
    };
    for (const planning::BudgetRow& r : b.rows) row(r.source, r.error);
    row("all together", b.total);
    page.table(t);
  }
}

}  // namespace

std::string plan_page(const planning::FlightPlan& p, const PlanInput& in) {
  report::Page page("Flight plan " + p.name, in.crs.name());
  if (p.warnings.empty())
    page.banner(report::Tone::good, "The plan can be flown, and nothing in it stands out.");
  else
    page.banner(report::Tone::caution,
                "The plan can be flown; " + core::counted(p.warnings.size(), "point needs", "points need") + " a look.");
  if (!p.warnings.empty()) page.list(p.warnings);
  page.section("The flight");
  add_figures(page, p);
  page.section("Maps");
  add_maps(page, p, in);
  page.section("Lines");
  add_lines(page, p);
  page.section("Errors by source");
  page.paragraph("Of a point on level ground, from the sigmas of sensor and trajectory, in the layout of Brandalize's table 10.");
  add_budget(page, p);
  if (p.eye_safety) {
    page.section("Eye safety");
    page.table(value_table("By IEC 60825-1:2014, for a small source, a Gaussian beam and clear air; the maker's distance takes precedence.",
                           {{"safe from (m)", number_text(p.eye_safety->height, 0)},
                            {"behind binoculars of 50 mm from (m)", number_text(p.eye_safety->with_binoculars, 0)},
                            {"least height above the ground (m)", number_text(p.eye_safety->lowest, 0)},
                            {"pulses that meet an eye", number_text(p.eye_safety->pulses, 1)}}));
  }
  page.section("Photogrammetry from the same height");
  page.table(value_table("Accuracies and contour intervals of a photogrammetric flight, Brandalize (12) to (14).",
                         {{"planimetry (m)", number_text(p.photo.planimetry, 2)},
                          {"heights (m)", number_text(p.photo.height, 2)},
                          {"contour interval, analogue instrument (m)", number_text(p.photo.analogue_interval, 2)},
                          {"contour interval, analytical plotter (m)", number_text(p.photo.analytical_interval, 2)},
                          {"contour interval, digital station (m)", number_text(p.photo.digital_interval, 2)}}));
  page.section("Cost");
  page.table(value_table("From the keys of [cost].", {{"hours of flight, transit included", number_text(p.cost.hours, 2)},
                                                      {"sorties", report::count_text(p.cost.sorties)},
                                                      {"cost (" + p.cost.currency + ")", number_text(p.cost.total, 0)}}));
  return page.html();
}

}  // namespace swath::pipeline
