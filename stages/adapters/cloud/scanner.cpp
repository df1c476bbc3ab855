// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/cloud/scanner.h"

#include <limits>

#include "georef/map_patch.h"

namespace swath::stages {

std::vector<Eigen::Vector3d> scanner_positions(const Context& context, const trajectory::Trajectory& trajectory, const core::Block& block,
                                               RunCache& cache) {
  const georef::MapPatches& map = cache.get([&] { return georef::MapPatches(context.crs); });
  Eigen::Vector3d lever;
  for (Eigen::Index a = 0; a < 3; ++a) lever[a] = context.survey.calibration.lever_arm_scanner[static_cast<size_t>(a)].value;
  const Eigen::Vector3d unit(context.unit, context.unit, context.crs.vertical_metres_per_unit());
  std::vector<Eigen::Vector3d> out(block.size(), Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  trajectory::Cursor cursor(trajectory);
  for (size_t p = 0; p < block.size(); ++p) {
    if (p > 0 && block.time[p] == block.time[p - 1]) {
      out[p] = out[p - 1];
    } else if (cursor.seek(block.time[p])) {
      const trajectory::Pose pose = cursor.pose(block.time[p]);
      out[p] = map(pose.position + pose.ecef_R_body * lever).cwiseProduct(unit) - block.origin;
    }
  }
  return out;
}

}  // namespace swath::stages
