// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/wrong_attitudes.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <optional>

#include "calib/block/block_adjust.h"
#include "calib/block/block_start.h"
#include "calib/block/checks/block_control_checks.h"
#include "calib/block/checks/block_mistakes.h"
#include "core/config/units.h"
#include "core/error.h"

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Root mean squares of the differences.
struct Difference {
  double sigmas = 0.0, angle = 0.0;  ///< rad
};

/// Of the attitudes of `read`'s images, as its angles give them, and the adjusted ones. An unknown boresight takes up what all images of a
/// camera have in common.
Difference difference_of(const ReadBlock& read, const ImageBlock& stated, const ImageBlock& adjusted) {
  std::vector<Vector3d> turns;
  std::vector<Vector3d> sums(stated.cameras.size(), Vector3d::Zero());
  std::vector<double> images(stated.cameras.size(), 0.0);
  for (const ImageAttitude& a : stated.attitudes) {
    const std::uint32_t camera = stated.images[a.image].camera;
    const Matrix3d body_R_local = adjusted.cameras[camera].body_R_camera * adjusted.images[a.image].camera_R_local;
    const Eigen::AngleAxisd turn(stated.cameras[camera].body_R_camera * read.block.images[a.image].camera_R_local *
                                 body_R_local.transpose());
    turns.emplace_back(turn.angle() * turn.axis());
    sums[camera] += turns.back(), images[camera] += 1.0;
  }
  Difference out;
  const auto n = static_cast<double>(3 * turns.size());
  for (size_t k = 0; k < turns.size(); ++k) {
    const ImageAttitude& a = stated.attitudes[k];
    const std::uint32_t camera = stated.images[a.image].camera;
    const bool is_held = stated.cameras[camera].boresight_sigma.isZero(0.0);
    const Vector3d e = is_held ? turns[k] : Vector3d(turns[k] - sums[camera] / images[camera]);
    out.sigmas += e.cwiseAbs2().cwiseQuotient(a.covariance.diagonal()).sum() / n;
    out.angle += e.squaredNorm() / n;
  }
  return {std::sqrt(out.sigmas), std::sqrt(out.angle)};
}

std::string degrees(double angle) {
  char text[40];
  std::snprintf(text, sizeof text, "%.2g deg", angle / core::degree);
  return text;
}

/// The same once the block is adjusted with the angles read as `m` has them: observed attitudes draw the images to themselves.
std::optional<Difference> adjusted_with(const Mistake& m, const ReadBlock& poses, const ReadBlock& stated, const BlockConfig& config) {
  ReadBlock other = poses;
  m.instead(other);
  ImageBlock block = stated.block;
  for (ImageAttitude& a : block.attitudes) {
    BlockImage& image = block.images[a.image];
    image.camera_R_local = other.block.images[a.image].camera_R_local;
    a.local_R_body = (block.cameras[image.camera].body_R_camera * image.camera_R_local).transpose();
  }
  const ImageBlock before = block;
  try {
    adjust_block(block, config.adjust);
  } catch (const core::Error&) {
    return {};
  }
  return difference_of(other, before, block);
}

}  // namespace

void refuse_wrong_attitudes(const ReadBlock& stated, const ReadBlock& adjusted, const BlockConfig& config) {
  constexpr double disagree = 3.0;  // sigmas
  if (stated.block.attitudes.empty()) return;
  ReadBlock poses;  // what angles are turned into poses with
  poses.block.cameras = stated.block.cameras, poses.block.images = stated.block.images;
  poses.frame = stated.frame, poses.angles = stated.angles;
  for (const StatedAngles& a : poses.angles)
    set_attitude(poses.block, a.image, body_attitude(poses, a.image, a.value, config.images.angles, *config.images.north));
  const Difference found = difference_of(poses, stated.block, adjusted.block);
  if (found.sigmas < disagree) return;
  std::optional<Mistake> best;
  double least = found.sigmas;
  for (const Mistake& m : mistakes_of_angles(poses, config)) {
    ReadBlock other = poses;
    m.instead(other);
    if (const double d = difference_of(other, stated.block, adjusted.block).sigmas; d < least) best = m, least = d;
  }
  if (!best) return;
  const std::optional<Difference> otherwise = adjusted_with(*best, poses, stated, config);
  if (otherwise && clearly * otherwise->sigmas < found.sigmas)
    throw core::Error(best->what + ": attitudes differ from those of the images by " + degrees(found.angle) +
                          " as stated (root mean square after the adjustment), by " + degrees(otherwise->angle) + " without that mistake",
                      config.images.file.string(), best->hint);
}

}  // namespace swath::calib
