// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/unfit_points.h"

namespace swath::calib {

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

}  // namespace swath::calib
