// SPDX-License-Identifier: GPL-3.0-or-later
// Covariance of all unknowns of a block, and what each observation is checked by: redundancy, w-test, reliability (Baarda 1968).
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "calib/block/block_normals.h"

namespace swath::calib {

/// Noncentrality of a test at 0.1 % with a power of 80 %: an error of delta0 sigma / sqrt(r) is found (inner reliability).
inline constexpr double delta0 = 4.13;

/// By the sigmas as given; in the unknowns' own units.
struct BlockInference {
  double smallest_pivot = 1.0;                          ///< of the scaled normal equations
  std::vector<std::uint32_t> unsound_points;            ///< whose rays are parallel: without covariance
  std::vector<Eigen::MatrixXd> nodes;                   ///< covariance of each node's unknowns
  std::vector<Eigen::MatrixXd> with_camera;             ///< per node of an image: with the free values of its camera; may be empty
  std::vector<int> camera_of;                           ///< per node of an image: the node of its camera; -1: it has no free values
  std::vector<Eigen::Matrix3d> points;                  ///< m^2; zero where a point takes no part
  std::vector<float> redundancy;                        ///< per row, 0 to 1
  std::vector<float> w;                                 ///< per row, residual over its own sigma; 0 where the redundancy is
  std::vector<float> outer;                             ///< per row of a ray: what the smallest error that is found moves its point, m
  std::array<double, 5> redundancy_of{}, squares_of{};  ///< by ObservationKind: sums of redundancies and of squared residuals
  double redundancy_lost = 0.0;                         ///< of image points without weight, which the sums leave out

  bool determined() const { return smallest_pivot > 1e-12; }
};

/// Where the block is not determined, with smallest_pivot and unsound_points alone. `of_ray`: robust weights of the image points; empty: 1.
BlockInference infer(const LinearBlock& linear, const std::vector<double>& of_ray = {});

}  // namespace swath::calib
