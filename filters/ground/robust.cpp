// SPDX-License-Identifier: GPL-3.0-or-later
// Kraus & Pfeifer 1998, "Determination of terrain models in wooded areas with airborne laser scanner data", ISPRS J. 53; Pfeifer, Stadler &
// Briese 2001, "Derivation of digital terrain models in the SCOP++ environment", OEEPE workshop on airborne laserscanning.
//
// Deviations (those of the interpolation itself: linear_prediction.cpp). In brackets what each does to the mean total error over seven
// ISPRS samples, in points, where it was measured:
// - A level is interpolated in computing units of 4 x 4 cells of the survey's own lattice from their own points and those of three cells
//   around, so that no result depends on a tile's extent. Surfaces of neighbouring units meet with a small step (six cells around: +0.02).
// - Each level keeps the lowest point of a cell; the papers also name the point nearest to the cells' mean for fine levels. Not measured.
// - Standard deviation, half width and band of a level follow from `sigma` and `roughness`; in SCOP++ each level has its own settings.
#include "filters/ground/robust.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <vector>

#include "filters/bins.h"
#include "filters/ground/linear_prediction.h"

namespace swath::filters {
namespace {

constexpr int unit_cells = 4;
constexpr int overlap_cells = 3;
constexpr double widening = 3.0;           // of the cells from level to level
constexpr double half_width_sigmas = 3.0;  // of a level's standard deviation
constexpr double band_half_widths = 3.0;   // where the weight of a point has gone to 0
constexpr double length_cells = 2.0;       // of the covariance

struct Level {
  double cell, sigma;

  double reach() const { return (unit_cells + overlap_cells) * cell; }
  double band() const { return band_half_widths * half_width_sigmas * sigma; }
};

/// Widest cells first.
std::vector<Level> levels_of(const RobustOptions& o) {
  std::vector<Level> out;
  for (int k = o.levels - 1; k >= 0; --k) {
    const double cell = o.cell.value * std::pow(widening, k);
    out.push_back({cell, std::hypot(o.sigma.value, o.roughness * cell)});
  }
  return out;
}

/// A surface in computing units. Coordinates are the block's.
class UnitSurface {
 public:
  /// From the lowest of the points at `rows` in every cell, in the units that touch [x0, x1] x [y0, y1] of map coordinates.
  UnitSurface(const core::Block& b, const std::vector<std::uint32_t>& rows, const Level& level, double x0, double y0, double x1, double y1)
      : b_(b), units_(core::lattice_of(unit_cells * level.cell, x0, y0, std::nextafter(x1, inf), std::nextafter(y1, inf))) {
    const core::Lattice cells{level.cell, units_.i0 * unit_cells - overlap_cells, units_.j0 * unit_cells - overlap_cells,
                              units_.nx * unit_cells + 2 * overlap_cells, units_.ny * unit_cells + 2 * overlap_cells};
    const auto lowest = lowest_of(cells, rows);
    surfaces_.resize(units_.size());
    const PredictionModel model{level.sigma, half_width_sigmas * level.sigma, length_cells * level.cell};
    std::vector<Eigen::Vector3d> points;
    for (int j = 0; j < units_.ny; ++j)
      for (int i = 0; i < units_.nx; ++i) {
        points.clear();
        for (int b0 = 0; b0 < unit_cells + 2 * overlap_cells; ++b0)
          for (int a0 = 0; a0 < unit_cells + 2 * overlap_cells; ++a0) {
            const auto p = lowest[cells.at(i * unit_cells + a0, j * unit_cells + b0)];
            if (p) points.emplace_back(b.x[*p] - middle_x(i), b.y[*p] - middle_y(j), b.z[*p]);
          }
        surfaces_[units_.at(i, j)] = predict_robustly(points, model);
      }
  }

  /// NaN outside the units and where no point is near.
  double height(std::uint32_t p) const {
    const CellIndex c = cell_of(units_, b_, p);
    if (!units_.holds(c.i, c.j)) return nothing;
    const PredictedSurface& s = surfaces_[units_.at(c.i, c.j)];
    return s.empty() ? nothing : s.height(b_.x[p] - middle_x(c.i), b_.y[p] - middle_y(c.j));
  }

 private:
  static constexpr double inf = std::numeric_limits<double>::infinity();
  static constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

  double middle_x(int i) const { return units_.centre_x(i) - b_.origin.x(); }
  double middle_y(int j) const { return units_.centre_y(j) - b_.origin.y(); }

  /// Ties: least x, then least y.
  std::vector<std::optional<std::uint32_t>> lowest_of(const core::Lattice& cells, const std::vector<std::uint32_t>& rows) const {
    std::vector<std::optional<std::uint32_t>> lowest(cells.size());
    const auto place = [this](std::uint32_t p) { return std::tie(b_.z[p], b_.x[p], b_.y[p]); };
    for (const std::uint32_t p : rows) {
      const CellIndex c = cell_of(cells, b_, p);
      if (!cells.holds(c.i, c.j)) continue;
      auto& least = lowest[cells.at(c.i, c.j)];
      if (!least || place(p) < place(*least)) least = p;
    }
    return lowest;
  }

  const core::Block& b_;
  core::Lattice units_;
  std::vector<PredictedSurface> surfaces_;
};

struct Extent {
  double x0, y0, x1, y1;
};
/// Of the own points that may be ground; none where there are none.
std::optional<Extent> extent_of(const core::Block& b, size_t own) {
  std::optional<Extent> e;
  for (size_t p = 0; p < own; ++p) {
    if (!may_be_ground(b, p)) continue;
    const double x = b.origin.x() + b.x[p], y = b.origin.y() + b.y[p];
    if (!e) e = Extent{x, y, x, y};
    e = Extent{std::min(e->x0, x), std::min(e->y0, y), std::max(e->x1, x), std::max(e->y1, y)};
  }
  return e;
}

}  // namespace

double halo(const RobustOptions& o) {
  constexpr double rounding = 1e-6;  // m
  double reach = rounding;
  for (const Level& level : levels_of(o)) reach += level.reach();
  return reach;
}

GroundCounts classify_ground_robust(core::Block& b, size_t own, const RobustOptions& o) {
  std::vector<Verdict> verdicts(b.size(), Verdict::object);
  const auto extent = extent_of(b, own);
  if (!extent) return set_ground_classes(b, own, verdicts);
  std::vector<std::uint32_t> taken;  // by the level at work
  for (std::uint32_t p = 0; p < b.size(); ++p)
    if (may_be_ground(b, p)) taken.push_back(p);

  const std::vector<Level> levels = levels_of(o);
  double around = halo(o);  // of the own points, that the level must serve
  for (const Level& level : levels) {
    around -= level.reach();
    const UnitSurface surface(b, taken, level, extent->x0 - around, extent->y0 - around, extent->x1 + around, extent->y1 + around);
    if (&level == &levels.back()) {
      for (std::uint32_t p = 0; p < own; ++p) {
        const double above = b.z[p] - (may_be_ground(b, p) ? surface.height(p) : 0.0);
        verdicts[p] = std::isnan(above) ? Verdict::no_surface : std::abs(above) <= o.tolerance.value ? Verdict::ground : Verdict::object;
      }
    } else {
      std::erase_if(taken, [&](std::uint32_t p) { return !(std::abs(b.z[p] - surface.height(p)) <= level.band()); });
    }
  }
  return set_ground_classes(b, own, verdicts);
}

}  // namespace swath::filters
