// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/terrain/contour_interval.h"

#include <algorithm>
#include <cmath>

#include "core/statistics.h"
#include "terrain/contours/map_class.h"

namespace swath::stages {
namespace {

/// Flying height above the mean terrain, m: NaN where the run has no trajectory on the map.
double flying_height(const Context& context, double mean_terrain) {
  if (!context.records.has<trajectory::Trajectory>() || context.crs.empty()) return std::nan("");
  const core::TrajectoryData& d = context.records.get<trajectory::Trajectory>().data();
  const core::Transform to_map(core::wgs84_geodetic(), context.crs);
  const size_t step = std::max<size_t>(1, d.size() / 1000);
  std::vector<double> heights;
  for (size_t k = 0; k < d.size(); k += step)
    heights.push_back(to_map({core::to_degrees(d.longitude[k]), core::to_degrees(d.latitude[k]), d.height[k]}).z() * context.vertical_unit);
  return core::median(std::move(heights)) - mean_terrain;
}

}  // namespace

SurfaceFacts facts_of(const core::Grid& grid, const core::Lattice& own, double interval) {
  SurfaceFacts f;
  const core::Lattice& l = grid.lattice;
  for (int j = 0; j < own.ny; ++j)
    for (int i = 0; i < own.nx; ++i) {
      const size_t at = l.at(static_cast<int>(own.i0 - l.i0) + i, static_cast<int>(own.j0 - l.j0) + j);
      if (std::isnan(grid.height[at])) continue;
      f.sum_of_heights += grid.height[at];
      ++f.heights;
      if (grid.sigma.empty() || std::isnan(grid.sigma[at])) continue;
      const double sigma = grid.sigma[at];
      f.sum_of_variances += sigma * sigma;
      ++f.sigmas;
      f.beyond += terrain::map_class_of(interval, sigma) == '-';
    }
  return f;
}

void judge_interval(const Context& context, const SurfaceFacts& f, double interval, core::Value& findings) {
  core::Value words = core::Value::array();
  if (f.heights > 0)
    if (const double height = flying_height(context, f.sum_of_heights / static_cast<double>(f.heights)); std::isfinite(height))
      findings["c_factor"] = height / interval;
  if (f.sigmas == 0) {
    words.push("the model has no sigma, so nothing says which interval it carries");
  } else {
    const double sigma = std::sqrt(f.sum_of_variances / static_cast<double>(f.sigmas));
    const char kept = terrain::map_class_of(interval, sigma);
    findings["model_sigma_m"] = sigma;
    findings["map_class"] = kept == '-' ? std::string("none") : std::string(1, kept);
    for (const terrain::MapClass& c : terrain::map_classes)
      findings["smallest_interval_m"][std::string(1, c.name)] = terrain::smallest_interval(c, sigma);
    findings["share_of_cells_below_class_c"] = static_cast<double>(f.beyond) / static_cast<double>(f.sigmas);
    if (kept == '-') {
      const std::string unit = context.vertical_unit == 1.0 ? " m" : " ft";
      const auto told = [&](double metres) { return core::format_number(metres / context.vertical_unit) + unit; };
      const auto carried = [&](size_t c) {
        return told(context.vertical_unit *
                    terrain::usual_interval(terrain::smallest_interval(terrain::map_classes[c], sigma) / context.vertical_unit));
      };
      words.push("contours every " + told(interval) + " say more than the model knows: its sigma of " +
                 core::format_number(std::round(sigma / context.vertical_unit * 1e3) / 1e3) + unit + " (rms) carries " + carried(0) +
                 " as class A, " + carried(1) + " as class B, " + carried(2) + " as class C");
    }
  }
  if (!words.items().empty()) findings["findings"] = std::move(words);
}

}  // namespace swath::stages
