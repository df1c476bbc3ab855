// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/cloud/scanner.h"

#include <limits>

namespace swath::stages {

std::vector<Eigen::Vector3d> ScannerPositions::of(const Context& context, const trajectory::Trajectory& trajectory,
                                                  const core::Block& block) const {
  const std::shared_ptr<const georef::MapPatches> map = patches(context);
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
      out[p] = (*map)(pose.position + pose.ecef_R_body * lever).cwiseProduct(unit) - block.origin;
    }
  }
  return out;
}

std::shared_ptr<const georef::MapPatches> ScannerPositions::patches(const Context& context) const {
  const std::lock_guard lock(mutex_);
  if (!patches_) patches_ = std::make_shared<georef::MapPatches>(context.crs);
  return patches_;
}

}  // namespace swath::stages
