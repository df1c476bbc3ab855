// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/flat_target_chart.h"

#include <algorithm>
#include <cmath>

#include "calib/report_units.h"
#include "core/config/units.h"

namespace swath::calib {
namespace {

using Eigen::Vector2d;

constexpr int grey_colour = 4;  // of the palette

/// Edges of one view in plan, displacements `enlarged`.
report::Series edges_in_plan(const FlatTarget& t, const TargetView& v, double enlarged, int colour, const std::string& name) {
  report::Series s{name, {}, {}, {}, report::Mark::line, colour};
  for (size_t k = 0; k < v.sides.size(); ++k) {
    const SideView& side = v.sides[k];
    if (!side.used) continue;
    const Vector2d a = t.target.corners[k], b = t.target.corners[(k + 1) % t.target.sides()], d = (b - a).normalized();
    const Vector2d outward(d.y(), -d.x());
    for (const double at : {-0.45, 0.45}) {
      const double along = at * (b - a).norm();
      const Vector2d p = 0.5 * (a + b) + along * d + enlarged * (side.offset + side.slope * (along - side.at)) * outward;
      s.x.push_back(p.x());
      s.y.push_back(p.y());
    }
    s.x.push_back(std::nan(""));
    s.y.push_back(std::nan(""));
  }
  return s;
}

/// A power of ten, or two or five of it, by which displacements become some metres long.
double enlargement(const FlatTarget& t, bool after) {
  double largest = 1e-3;
  for (const TargetLine& l : t.lines) {
    const TargetView& v = after ? l.after : l.before;
    if (v.seen)
      for (const SideView& s : v.sides)
        if (s.used) largest = std::max(largest, std::abs(s.offset));
  }
  constexpr double shown = 6.0;  // m on the plan
  const double ratio = std::max(1.0, shown / largest), ten = std::pow(10.0, std::floor(std::log10(ratio)));
  return ratio / ten >= 5.0 ? 5.0 * ten : ratio / ten >= 2.0 ? 2.0 * ten : ten;
}

report::Panel plan(const FlatTarget& t, bool after) {
  const double enlarged = enlargement(t, after);
  report::Panel p;
  p.title = std::string(after ? "Edges after" : "Edges before") + ", displacements enlarged " + core::format_number(enlarged) + " times";
  p.x_label = after ? "east (m) " : "east (m)";
  p.y_label = "north (m)";
  p.equal_scale = true;
  report::Series outline{t.target.surveyed ? "surveyed" : "mean", {}, {}, {}, report::Mark::line, grey_colour};
  for (size_t k = 0; k <= t.target.sides(); ++k) {
    outline.x.push_back(t.target.corners[k % t.target.sides()].x());
    outline.y.push_back(t.target.corners[k % t.target.sides()].y());
  }
  p.series.push_back(outline);
  int colour = 0;
  for (const TargetLine& l : t.lines) {
    if (!l.measured) continue;
    if (colour == grey_colour) ++colour;
    p.series.push_back(edges_in_plan(t, after ? l.after : l.before, enlarged, colour++, "line " + std::to_string(l.line)));
  }
  return p;
}

report::Panel readings(const std::string& name, const TargetAngle& a) {
  report::Panel p;
  p.title = name + ": readings less the mean, with their sigmas";
  p.x_label = "reading of " + name;
  p.y_label = "arcsec";
  report::Series mean{"sigma of the mean", {0.5, static_cast<double>(a.readings.size()) + 0.5}, {}, {}, report::Mark::band, grey_colour};
  mean.y.assign(2, a.sigma / arc_second);
  p.series.push_back(mean);
  report::Series dots{"", {}, {}, {}, report::Mark::dots, 0}, bars{"", {}, {}, {}, report::Mark::line, 0};
  for (size_t i = 0; i < a.readings.size(); ++i) {
    const double x = static_cast<double>(i + 1), y = (a.readings[i].value - a.mean) / arc_second, s = a.readings[i].sigma / arc_second;
    dots.x.push_back(x);
    dots.y.push_back(y);
    for (const double end : {y - s, y + s}) {
      bars.x.push_back(x);
      bars.y.push_back(end);
    }
    bars.x.push_back(std::nan(""));
    bars.y.push_back(std::nan(""));
  }
  p.series.push_back(bars);
  p.series.push_back(dots);
  return p;
}

report::Panel displacements(const FlatTarget& t) {
  report::Panel p;
  p.title = "Displacement of the target in each line, before";
  p.x_label = "line";
  p.y_label = "m";
  report::Series along{"along", {}, {}, {}, report::Mark::dots, 0}, across{"across", {}, {}, {}, report::Mark::dots, 1},
      up{"up", {}, {}, {}, report::Mark::dots, 2};
  for (const TargetLine& l : t.lines) {
    if (!l.before.seen) continue;
    constexpr double vague = 0.5;  // m
    const auto add = [&](report::Series& s, double shift, double value) {
      s.x.push_back(l.line + shift);
      s.y.push_back(value);
    };
    constexpr double beside = 0.1;
    add(along, -beside, l.before.displacement.x());
    if (l.before.covariance(1, 1) < vague * vague) add(across, 0.0, l.before.displacement.y());
    add(up, beside, l.before.height);
  }
  p.series = {along, across, up};
  return p;
}

}  // namespace

report::Chart chart_of(const FlatTarget& t) {
  report::Chart c;
  c.title = "Flat target: " + t.target.name;
  if (!t.done) return c;
  c.panels = {displacements(t), plan(t, false), plan(t, true)};
  for (const auto& [name, a] : {std::pair{"pitch", &t.pitch}, {"roll", &t.roll}, {"heading", &t.heading}})
    if (a->determined) c.panels.push_back(readings(name, *a));
  c.panel_height = 320;
  return c;
}

}  // namespace swath::calib
