// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/figures.h"

#include <algorithm>
#include <array>

#include "calib/report/verdict.h"
#include "calib/report_units.h"
#include "core/config/units.h"
#include "report/difference_map.h"

namespace swath::calib {
namespace {

using report::Chart;
using report::Mark;
using report::Panel;
using report::Series;

constexpr int grey = 4, colours = 7;
/// Share of the groups in use that the range of a panel goes by: a few far off, and those taken out, do not flatten the rest.
constexpr double residual_share = 0.99;

std::string line_name(int id) { return "line " + std::to_string(id); }

/// Index of a line among those of the flight.
size_t index_of(const CalibrationReport& report, int line) {
  const auto& lines = report.ties.lines;
  return static_cast<size_t>(std::find_if(lines.begin(), lines.end(), [&](const calib::TieLine& l) { return l.id == line; }) -
                             lines.begin());
}

const char* label_of(BinBy by) {
  switch (by) {
    case BinBy::line:
      return "flight line";
    case BinBy::angle:
      return "scan angle, positive to starboard (deg)";
    case BinBy::range:
      return "range (m)";
    case BinBy::time:
      break;
  }
  return "time since the first return (s)";
}

const char* title_of(BinBy by) {
  switch (by) {
    case BinBy::line:
      return "Distances from the tie planes by line";
    case BinBy::angle:
      return "Distances from the tie planes by scan angle";
    case BinBy::range:
      return "Distances from the tie planes by range";
    case BinBy::time:
      break;
  }
  return "Distances from the tie planes by time";
}

/// Groups of one kind stand side by side: the k-th of n.
double spread(size_t k, size_t n) { return n > 1 ? 0.7 * (static_cast<double>(k) / static_cast<double>(n - 1) - 0.5) : 0.0; }

Panel residual_panel(const CalibrationReport& report, BinBy by, bool before) {
  const auto& groups = report.adjustment.groups;
  Panel p;
  p.title = before ? "Before: start values" : "After the adjustment";
  p.x_label = label_of(by);
  p.y_label = "distance (cm)";
  const auto used = std::count_if(groups.begin(), groups.end(), [](const calib::GroupResidual& g) { return !g.rejected; });
  // A little less than that share of all: those taken out lie on one side as a rule.
  p.y_share = groups.empty() ? 1.0 : 1.0 - 2.0 * (1.0 - residual_share * static_cast<double>(used) / static_cast<double>(groups.size()));
  p.y_share = std::max(p.y_share, 0.5);
  std::vector<size_t> seen(report.ties.lines.size()), all(report.ties.lines.size());
  for (const auto& g : groups) ++all[g.line];
  for (size_t k = 0; k < report.ties.lines.size(); ++k) {
    p.series.push_back({before ? line_name(report.ties.lines[k].id) : "", {}, {}, {}, Mark::dots, line_colour(k)});
    if (by == BinBy::line) p.x_names.push_back(std::to_string(report.ties.lines[k].id));
  }
  Series taken_out{before ? "taken out" : "", {}, {}, {}, Mark::dots, grey};
  for (const auto& g : groups) {
    const double x = by == BinBy::line ? static_cast<double>(g.line) + spread(seen[g.line]++, all[g.line]) : bin_value(g, report.ties, by);
    Series& s = g.rejected ? taken_out : p.series[g.line];
    s.x.push_back(x);
    s.y.push_back((before ? g.before : g.after) / centimetre);
  }
  if (!taken_out.x.empty()) p.series.push_back(std::move(taken_out));
  return p;
}

}  // namespace

int line_colour(size_t k) {
  constexpr std::array<int, 6> order{0, 1, 2, 3, 5, 6};
  return static_cast<int>(k / order.size()) * colours + order[k % order.size()];
}

Chart residual_chart(const CalibrationReport& report, BinBy by) {
  Chart c;
  c.title = title_of(by);
  c.panel_height = 220;
  c.panels = {residual_panel(report, by, true), residual_panel(report, by, false)};
  return c;
}

std::optional<Chart> correction_chart(const CalibrationReport& report) {
  static constexpr std::array<const char*, 6> names{"north", "east", "down", "roll", "pitch", "heading"};
  if (report.adjustment.corrections.empty()) return std::nullopt;
  const double first = first_time(report.ties);
  Chart c;
  c.title = "Corrections of the trajectory, with their sigmas";
  c.panel_height = 150;
  for (size_t axis = 0; axis < 6; ++axis) {
    const double unit = axis < 3 ? centimetre : arc_second;
    Panel p;
    p.x_label = label_of(BinBy::time);
    p.y_label = std::string(names[axis]) + (axis < 3 ? " (cm)" : " (arcsec)");
    for (const calib::LineCorrection& line : report.adjustment.corrections) {
      const int colour = line_colour(index_of(report, line.line));
      Series band{"", {}, {}, {}, Mark::band, colour}, value{axis == 0 ? line_name(line.line) : "", {}, {}, {}, Mark::line, colour};
      for (size_t k = 0; k < line.time.size(); ++k) {
        const double t = line.time[k] - first, v = line.value[k][axis] / unit;
        const double s = k < line.sigma.size() ? line.sigma[k][axis] / unit : calib::not_known;
        value.x.push_back(t);
        value.y.push_back(v);
        band.x.push_back(t);
        band.y.push_back(v + s);
        band.y2.push_back(v - s);
      }
      p.series.push_back(std::move(band));
      p.series.push_back(std::move(value));
    }
    c.panels.push_back(std::move(p));
  }
  return c;
}

std::optional<report::CorrelationChart> correlation_chart(const CalibrationReport& report) {
  const calib::Adjustment& a = report.adjustment;
  report::CorrelationChart c;
  c.title = "Correlations of the parameters";
  for (int k = 0; k < estimated_count; ++k)
    if (a.estimates[static_cast<size_t>(k)].estimated) c.names.emplace_back(words_of(parameter_at(k)).name);
  const auto n = static_cast<Eigen::Index>(c.names.size());
  if (n < 2 || a.correlation.rows() != n || a.correlation.cols() != n) return std::nullopt;
  for (Eigen::Index r = 0; r < n; ++r)
    for (Eigen::Index k = 0; k < n; ++k) c.values.push_back(a.correlation(r, k));
  return c;
}

Chart section_chart(const CalibrationReport& report, const CrossSection& section, size_t most) {
  Chart c;
  c.title = section.name;
  for (const bool before : {true, false}) {
    Panel p;
    p.title = before ? "Before: start values" : "After the adjustment";
    p.x_label = "along the section (m)";
    p.y_label = "height (m)";
    for (const SectionPoints& line : before ? section.before : section.after) {
      Series s{line_name(line.line), {}, {}, {}, Mark::dots, line_colour(index_of(report, line.line))};
      const size_t every = line.along.size() / std::max<size_t>(most, 1) + 1;
      for (size_t k = 0; k < line.along.size(); k += every) {
        s.x.push_back(line.along[k]);
        s.y.push_back(line.height[k]);
      }
      p.series.push_back(std::move(s));
    }
    c.panels.push_back(std::move(p));
  }
  return c;
}

core::Picture difference_map(const LineDifference& d, bool before) {
  report::DifferenceMapOptions o;
  o.title = "Line " + std::to_string(d.line_a) + " minus line " + std::to_string(d.line_b) + (before ? ", before" : ", after");
  return report::draw(report::difference_map(before ? d.before : d.after, o));
}

}  // namespace swath::calib
