// SPDX-License-Identifier: GPL-3.0-or-later
// Zhang, Chen, Whitman, Shyu, Yan & Zhang 2003, "A progressive morphological filter for removing nonground measurements from airborne LIDAR
// data", IEEE TGRS 41(4), by PCL's pcl::ProgressiveMorphologicalFilter.
//
// PCL opens the points it is given, each over the points within half a window of it. Here these are the paper's raster: the lowest point of
// each cell, at the cell's centre, in coordinates counted in cells, so that a window holds a whole number of cells and single precision
// decides nothing. The raster is cut into squares of the survey's own lattice (patches.h) with a margin of the sum of all windows, beyond
// which nothing has influence: no result depends on the tile, and there are no seams.
//
// Deviations. In brackets what each does to the mean total error over seven ISPRS samples, in points, where it was measured:
// - Cells without a point get their height by interpolation within a bounded reach (inpaint.h), not from the nearest point. Not measured.
// - A further point of a cell whose lowest is ground is ground up to eq 7's height for its distance from the lowest; the paper drops it.
// - A step opens only what the last one has kept, as PCL does; the paper opens the last step's opened surface. Not measured.
// - PCL multiplies the growth of the threshold (eq 7) by the cell although its windows are in metres already; in coordinates counted in
//   cells both agree, so this one is undone.
// - Heights are rounded to single precision: 0.03 mm at 500 m above the square's lowest point.
#include "filters/ground/pmf.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/segmentation/progressive_morphological_filter.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "filters/bins.h"
#include "filters/ground/inpaint.h"
#include "filters/ground/patches.h"

namespace swath::filters {
namespace {

constexpr float base = 2.0F;  // Zhang2003, b
constexpr Inpainting pmf_filling{.reach = 10, .relax = 0, .extrapolate = true};
constexpr int patch_windows = 4;  // side of a patch in widest windows

/// Windows in cells, up to the first that is at least the largest. Zhang2003 eq 4 and 5.
std::vector<double> windows(const PmfOptions& o) {
  std::vector<double> out;
  const double largest = o.max_window_size / o.cell_size;
  for (int k = 0; out.empty() || out.back() < largest; ++k)
    out.push_back(o.exponential ? 2.0 * std::pow(static_cast<double>(base), k) + 1.0 : 2.0 * (k + 1) * static_cast<double>(base) + 1.0);
  return out;
}

/// Cells.
struct Squares {
  int side = 0, margin = pmf_filling.support() + 1;

  explicit Squares(const PmfOptions& o) {
    for (const double w : windows(o)) {
      margin += static_cast<int>(w);  // half a window each for what is lowered and what is raised again
      side = patch_windows * static_cast<int>(w);
    }
  }
  Patching patching(const PmfOptions& o) const { return {side * o.cell_size.value, margin * o.cell_size.value}; }
};

/// The lowest point of each cell; ties: the first.
std::vector<std::optional<std::uint32_t>> lowest_of(const core::Block& b, const std::vector<std::uint32_t>& rows, const core::Lattice& l) {
  std::vector<std::optional<std::uint32_t>> lowest(l.size());
  for (const std::uint32_t p : rows) {
    const CellIndex c = cell_of(l, b, p);
    if (!l.holds(c.i, c.j)) continue;  // on the margin's edge, by rounding
    auto& least = lowest[l.at(c.i, c.j)];
    if (!least || b.z[p] < b.z[*least]) least = p;
  }
  return lowest;
}

/// Per cell of the surface whether it is ground.
std::vector<bool> ground_cells(const Raster& surface, const PmfOptions& o) {
  const auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  std::vector<size_t> cells;
  for (int j = 0; j < surface.ny; ++j)
    for (int i = 0; i < surface.nx; ++i) {
      const size_t c = surface.at(i, j);
      if (std::isnan(surface.value[c])) continue;
      cloud->emplace_back(static_cast<float>(i), static_cast<float>(j), surface.value[c]);
      cells.push_back(c);
    }
  pcl::ProgressiveMorphologicalFilter<pcl::PointXYZ> filter;
  filter.setInputCloud(cloud);
  filter.setCellSize(1.0F);
  filter.setBase(base);
  filter.setExponential(o.exponential);
  filter.setMaxWindowSize(static_cast<int>(std::ceil(o.max_window_size / o.cell_size)));
  filter.setSlope(static_cast<float>(o.slope * o.cell_size.value));
  filter.setInitialDistance(static_cast<float>(o.initial_distance.value));
  filter.setMaxDistance(static_cast<float>(o.max_distance.value));
  pcl::Indices kept;
  filter.extract(kept);
  std::vector<bool> ground(surface.value.size(), false);
  for (const auto k : kept) ground[cells[static_cast<size_t>(k)]] = true;
  return ground;
}

}  // namespace

double halo(const PmfOptions& o) { return Squares(o).patching(o).halo(); }

GroundCounts classify_ground_pmf(core::Block& b, size_t own, const PmfOptions& o) {
  std::vector<Verdict> verdicts(b.size(), Verdict::object);
  const auto takes_part = [&b](size_t p) { return may_be_ground(b, p); };
  const Squares squares(o);
  const double cell = o.cell_size.value;
  for_each_patch(b, own, squares.patching(o), takes_part, [&](const Patch& patch) {
    const int n = squares.side + 2 * squares.margin;
    const core::Lattice l{cell, std::llround(patch.x0 / cell) - squares.margin, std::llround(patch.y0 / cell) - squares.margin, n, n};
    const auto lowest = lowest_of(b, patch.rows, l);
    double datum = std::numeric_limits<double>::infinity();
    for (const auto& p : lowest)
      if (p) datum = std::min(datum, b.z[*p]);
    Raster surface(n, n, std::numeric_limits<float>::quiet_NaN());
    for (size_t c = 0; c < lowest.size(); ++c)
      if (lowest[c]) surface.value[c] = static_cast<float>(b.z[*lowest[c]] - datum);
    const std::vector<bool> ground = ground_cells(inpaint(surface, pmf_filling), o);

    for (const std::uint32_t p : patch.rows) {
      if (!patch.owns(b.origin.x() + b.x[p], b.origin.y() + b.y[p])) continue;
      const CellIndex c = cell_of(l, b, p);
      if (!l.holds(c.i, c.j) || !ground[l.at(c.i, c.j)]) continue;
      const std::uint32_t q = *lowest[l.at(c.i, c.j)];
      const double above = o.initial_distance.value + o.slope * std::hypot(b.x[p] - b.x[q], b.y[p] - b.y[q]);
      if (b.z[p] - b.z[q] <= std::min(above, o.max_distance.value)) verdicts[p] = Verdict::ground;
    }
  });
  return set_ground_classes(b, own, verdicts);
}

}  // namespace swath::filters
