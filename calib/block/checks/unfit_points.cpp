// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/unfit_points.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace swath::calib {
namespace {

/// Points whose rays are parallel, or whose position has a standard deviation of more than a third of the distance.
std::set<std::uint32_t> parallel_points(const ImageBlock& block, const BlockInference& found) {
  constexpr double most = 1.0 / 3.0;
  std::set<std::uint32_t> out(found.unsound_points.begin(), found.unsound_points.end());
  if (found.points.empty()) return out;
  for (const ImageRay& r : block.rays) {
    if (block.points[r.point].left_out) continue;
    const double distance = (block.points[r.point].position - block.images[r.image].position).norm();
    if (std::sqrt(found.points[r.point].trace()) > most * distance) out.insert(r.point);
  }
  return out;
}

}  // namespace

UnfitPoints unfit_points(const ImageBlock& block, const std::vector<double>& weight) {
  constexpr double fits = 0.5;
  std::vector<int> rays(block.points.size(), 0), fitting(block.points.size(), 0), seen(block.images.size(), 0),
      lost(block.images.size(), 0);
  for (size_t r = 0; r < block.rays.size(); ++r) {
    ++rays[block.rays[r].point];
    ++seen[block.rays[r].image];
    (weight[r] >= fits ? fitting[block.rays[r].point] : lost[block.rays[r].image]) += 1;
  }
  std::vector<char> is_control(block.points.size(), 0);
  for (const BlockControl& c : block.control)
    if (!c.check) is_control[c.point] = 1;
  UnfitPoints out;
  out.of_point.assign(block.points.size(), 0);
  for (size_t p = 0; p < block.points.size(); ++p) {
    if (is_control[p] && 2 * fitting[p] < rays[p]) out.control.push_back(block.points[p].name);
    if (is_control[p] || rays[p] < 2 || fitting[p] >= 2) continue;
    out.of_point[p] = 1;
    out.others.push_back(block.points[p].name);
  }
  for (size_t i = 0; i < block.images.size(); ++i)
    if (3 * lost[i] > seen[i]) out.images.push_back(block.images[i].name);
  return out;
}

bool leave_out_parallel(ImageBlock& block, const BlockInference& found) {
  constexpr size_t one_in = 10;
  const std::set<std::uint32_t> points = parallel_points(block, found);
  const auto before =
      static_cast<size_t>(std::count_if(block.points.begin(), block.points.end(), [](const BlockPoint& p) { return p.left_out; }));
  if (points.empty() || one_in * (before + points.size()) > block.points.size()) return false;
  for (const std::uint32_t p : points) block.points[p].left_out = true;
  return true;
}

}  // namespace swath::calib
