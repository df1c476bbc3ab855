// SPDX-License-Identifier: GPL-3.0-or-later
// Zhang, Chen, Whitman, Shyu, Yan & Zhang 2003, "A progressive morphological filter for removing nonground measurements from airborne LIDAR
// data", IEEE TGRS 41(4), by PCL's pcl::ProgressiveMorphologicalFilter.
//
// PCL opens the points themselves: each step sees the points within half a window of a point, so the result is local. It computes in single
// precision and from wherever its coordinates start; here it is given squares of the survey's own lattice (patches.h), in coordinates from
// the square's centre, with a margin of the sum of all windows, beyond which nothing has influence. So no result depends on the tile.
//
// Deviations, all PCL's:
// - Points are opened, not the lowest points of raster cells. Not measured.
// - The windows are the paper's, 2 b^k + 1 or 2 k b + 1 cells with b = 2; PCL multiplies the threshold's growth (eq 7) by the cell although
// its
//   windows are in metres already. Here PCL gets coordinates in cells, where both agree: this deviation is undone.
// - Heights and distances are rounded to single precision: 0.02 mm at 300 m from the square's centre or height.
#include "filters/pmf.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/segmentation/progressive_morphological_filter.h>

#include <algorithm>
#include <cmath>

#include "filters/patches.h"

namespace swath::filters {
namespace {

constexpr float base = 2.0F;  // Zhang2003, b

/// Windows in cells, up to the first that is at least the largest. Zhang2003 eq 4 and 5.
std::vector<double> windows(const PmfOptions& o) {
  std::vector<double> out;
  const double largest = o.max_window_size / o.cell_size;
  for (int k = 0; out.empty() || out.back() < largest; ++k)
    out.push_back(o.exponential ? 2.0 * std::pow(static_cast<double>(base), k) + 1.0 : 2.0 * (k + 1) * static_cast<double>(base) + 1.0);
  return out;
}

Patching patching(const PmfOptions& o) {
  double reach = 1.0;  // for single precision
  double widest = 0.0;
  for (const double w : windows(o)) {
    reach += w;  // half a window each for what is lowered and what is raised again
    widest = w;
  }
  return {2.0 * widest * o.cell_size.value, reach * o.cell_size.value};
}

}  // namespace

double halo(const PmfOptions& o) { return patching(o).halo(); }

GroundCounts classify_ground_pmf(core::Block& b, size_t own, const PmfOptions& o) {
  std::vector<Verdict> verdicts(b.size(), Verdict::object);
  const auto takes_part = [&b](size_t p) { return may_be_ground(b, p); };
  for_each_patch(b, own, patching(o), takes_part, [&](const Patch& patch) {
    const double cell = o.cell_size.value;
    const double middle_x = patch.x0 + 0.5 * patch.side - b.origin.x(), middle_y = patch.y0 + 0.5 * patch.side - b.origin.y();
    double lowest = b.z[patch.rows.front()];
    for (const std::uint32_t p : patch.rows) lowest = std::min(lowest, b.z[p]);
    const auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
    cloud->reserve(patch.rows.size());
    for (const std::uint32_t p : patch.rows)
      cloud->emplace_back(static_cast<float>((b.x[p] - middle_x) / cell), static_cast<float>((b.y[p] - middle_y) / cell),
                          static_cast<float>(b.z[p] - lowest));

    pcl::ProgressiveMorphologicalFilter<pcl::PointXYZ> filter;
    filter.setInputCloud(cloud);
    filter.setCellSize(1.0F);
    filter.setBase(base);
    filter.setExponential(o.exponential);
    filter.setMaxWindowSize(static_cast<int>(std::ceil(o.max_window_size / o.cell_size)));
    filter.setSlope(static_cast<float>(o.slope * cell));
    filter.setInitialDistance(static_cast<float>(o.initial_distance.value));
    filter.setMaxDistance(static_cast<float>(o.max_distance.value));
    pcl::Indices ground;
    filter.extract(ground);
    for (const auto k : ground) {
      const std::uint32_t p = patch.rows[static_cast<size_t>(k)];
      if (patch.owns(b.origin.x() + b.x[p], b.origin.y() + b.y[p])) verdicts[p] = Verdict::ground;
    }
  });
  return set_ground_classes(b, own, verdicts);
}

}  // namespace swath::filters
