// SPDX-License-Identifier: GPL-3.0-or-later
// What is adjusted by least squares has the covariance C_x, and its difference from an observation that took part C_l - C_x.
#include "calib/block/navigation/direct_comparison.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "core/config/units.h"
#include "core/geo/frames.h"
#include "core/statistics.h"

namespace swath::calib {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr std::array<const char*, 6> component_names{"east", "north", "up", "tilt about x", "tilt about y", "turn"};

/// Variances of direct orientation, grid and camera axes: the trajectory's by the factors that the adjustment used, lever arm, boresight.
Vector6 direct_variances(const ReadBlock& stated, std::uint32_t image, const BlockWeights& weights) {
  const BlockCamera& camera = stated.block.cameras[stated.block.images[image].camera];
  const PoseCovariance& C = stated.covariance[image];
  Vector6 out;
  out << C.diagonal().head<3>() * std::pow(weights.station, 2),
      (camera.body_R_camera.transpose() * C.bottomRightCorner<3, 3>() * camera.body_R_camera).diagonal() * std::pow(weights.attitude, 2);
  out.head<3>() += camera.antenna_sigma.cwiseAbs2();
  out.tail<3>() += camera.boresight_sigma.cwiseAbs2();
  return out;
}

/// Integrated less direct, and the variances of the former.
void difference_of(const ReadBlock& stated, const ReadBlock& adjusted, std::uint32_t image, const Eigen::MatrixXd& covariance,
                   Vector6& difference, Vector6& variances) {
  const BlockImage &before = stated.block.images[image], &after = adjusted.block.images[image];
  const Eigen::Matrix3d grid = adjusted.frame.local_R_grid(after.position).transpose();
  difference << grid * (after.position - before.position), core::log_so3(after.camera_R_local * before.camera_R_local.transpose());
  variances << (grid * covariance.topLeftCorner<3, 3>() * grid.transpose()).diagonal(), covariance.diagonal().tail<3>();
}

}  // namespace

std::vector<DirectCompared> compare_direct(const ReadBlock& stated, const ReadBlock& adjusted, const BlockSolution& s) {
  std::vector<DirectCompared> out;
  if (stated.covariance.empty()) return out;
  std::array<std::vector<double>, 6> direct, integrated, difference, over;
  for (size_t n = 0; n < s.linear.nodes.size(); ++n) {
    if (s.linear.nodes[n].kind != NodeKind::image) continue;
    const std::uint32_t image = s.linear.nodes[n].index;
    Vector6 d, after;
    difference_of(stated, adjusted, image, s.inference.nodes[n], d, after);
    const Vector6 before = direct_variances(stated, image, s.weights);
    for (int k = 0; k < 6; ++k) {
      const auto i = static_cast<size_t>(k);
      direct[i].push_back(std::sqrt(before[k])), integrated[i].push_back(std::sqrt(after[k])), difference[i].push_back(d[k]);
      if (before[k] > after[k]) over[i].push_back(d[k] / std::sqrt(before[k] - after[k]));
    }
  }
  for (size_t i = 0; i < 6; ++i) {
    const double unit = i < 3 ? 1.0 : 1.0 / core::degree;
    DirectCompared c;
    c.component = component_names[i], c.unit = i < 3 ? "m" : "deg";
    c.direct = unit * core::median(direct[i]), c.integrated = unit * core::median(integrated[i]);
    c.is_known = std::isfinite(c.direct);
    // An unknown shift, drift or turn of the trajectory is in the differences and in none of their sigmas.
    const ImageBlock& b = stated.block;
    const bool is_moved = i < 3 ? b.datum != Datum::none || b.drift_sets != DriftSets::none : b.datum == Datum::similarity;
    c.is_tested = c.is_known && !is_moved && !over[i].empty() && !b.stations.empty() && !b.attitudes.empty();
    double sum = 0.0, squares = 0.0, weighted = 0.0;
    for (const double v : difference[i]) sum += v, squares += v * v;
    for (const double v : over[i]) weighted += v * v;
    const auto images = static_cast<double>(difference[i].size());
    c.mean = unit * sum / images, c.rms = unit * std::sqrt(squares / images);
    c.over_sigma = over[i].empty() ? 0.0 : std::sqrt(weighted / static_cast<double>(over[i].size()));
    out.push_back(c);
  }
  return out;
}

}  // namespace swath::calib
