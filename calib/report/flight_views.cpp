// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/flight_views.h"

#include <algorithm>
#include <cmath>

#include "calib/ties/check_points.h"
#include "calib/ties/cross_sections.h"
#include "core/grid_units.h"
#include "core/paste.h"
#include "georef/georeference.h"

namespace swath::calib {
namespace {

/// One geometry at work: the flight's returns in map metres, and what is shown of them.
class View {
 public:
  View(const CalibrationFlight& flight, const FlightMap& map, const Geometry& g, const LineHeightOptions& heights, double cell)
      : metres_(map.unit, map.unit, map.crs.vertical_metres_per_unit()),
        origin_(map.origin),
        georeferencer_(flight.scanner, g.calibration, flight.sensor, g.trajectory, map.crs, origin_.cwiseQuotient(metres_), false),
        heights_(heights, cell) {}
  void cut(const std::vector<SectionPlan>& plans) { sections_ = SectionReturns(plans); }
  core::Block add(int line, const core::Shots& shots) {
    core::Block block;
    block.origin = georeferencer_.origin();
    georeferencer_.run(shots, block);
    core::scale_columns(metres_.x(), metres_.z(), block);
    block.origin = origin_;
    heights_.add(line, block);
    sections_.add(line, block);
    return block;
  }
  /// Local frame to map metres.
  Eigen::Vector3d place(const Eigen::Vector3d& ecef) const { return georeferencer_.map()(ecef).cwiseProduct(metres_); }
  const georef::MapPatches& map() const { return georeferencer_.map(); }
  std::vector<LineDifferenceMap> differences() { return line_differences(heights_); }
  std::vector<SectionPoints> section(size_t k) const {
    std::vector<SectionPoints> out;
    for (const auto& [line, r] : sections_.of(k)) out.push_back({line, r.along, r.height});
    return out;
  }

 private:
  Eigen::Vector3d metres_, origin_;
  georef::Georeferencer georeferencer_;
  LineHeights heights_;
  SectionReturns sections_{{}};
};

void add_differences(const std::vector<LineDifferenceMap>& before, std::vector<LineDifferenceMap>& after, CalibrationReport& report) {
  for (LineDifferenceMap& a : after) {
    LineDifference both{a.statistics.line_a, a.statistics.line_b, core::Grid(a.grid.lattice), std::move(a.grid)};
    for (const LineDifferenceMap& b : before)
      if (b.statistics.line_a == both.line_a && b.statistics.line_b == both.line_b) core::paste(b.grid, both.before);
    report.differences.push_back(std::move(both));
  }
}

void add_checks(const std::vector<CheckResidual>& checks, CalibrationReport& report) {
  std::string bare;
  for (const CheckResidual& c : checks) {
    if (std::isfinite(c.difference))
      report.checks.push_back({c.name, 0, c.difference, c.sigma, 1.0, c.difference / c.sigma, false});
    else
      bare += (bare.empty() ? "" : ", ") + c.name;
  }
  if (!bare.empty()) report.notes.push_back("Check points that too few returns lie around to be compared: " + bare + ".");
}

}  // namespace

BeforeAndAfter add_views(const CalibrationFlight& flight, const FlightMap& map, const Geometry& result, const LineHeightOptions& heights,
                         double cell, int sections, CalibrationReport& report) {
  constexpr double around = 2.0;  // m
  View was(flight, map, {flight.start, *flight.trajectory}, heights, cell), is(flight, map, result, heights, cell);
  const std::vector<SectionPlan> plans = plan_sections(report.ties, is.map(), map.unit, static_cast<size_t>(sections));
  was.cut(plans);
  is.cut(plans);
  const trajectory::LocalFrame& frame = report.ties.frame;
  CheckPoints checks(check_points_of(flight.targets, [&](const Eigen::Vector3d& local) { return is.place(frame.to_ecef(local)); }), around);
  flight.shots([&](int line, const core::Shots& shots) {
    was.add(line, shots);
    checks.add(is.add(line, shots));
  });
  for (size_t k = 0; k < plans.size(); ++k)
    report.sections.push_back({plans[k].name, plans[k].width, plans[k].ends, was.section(k), is.section(k)});
  const std::vector<LineDifferenceMap> before = was.differences();
  std::vector<LineDifferenceMap> after = is.differences();
  const BeforeAndAfter rms{overall_rms(before), overall_rms(after)};
  add_differences(before, after, report);
  add_checks(checks.residuals(), report);
  return rms;
}

}  // namespace swath::calib
