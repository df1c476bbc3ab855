// SPDX-License-Identifier: GPL-3.0-or-later
// Normal equations of a linearised block, the points eliminated one by one.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/block/block_system.h"
#include "calib/sparse/node_matrix.h"

namespace swath::calib {

/// PointPart::smallest_pivot, about the square of the angle between rays, up to which they are parallel: below what is measured (1e-5 rad),
/// and above what would cost the digits of the normal equations. The point is eliminated as if it were known.
inline constexpr double parallel_rays = 1e-9;

/// What a point has in the normal equations of its observations.
struct PointPart {
  std::vector<int> nodes;                             ///< that its rays touch, rising
  std::vector<int> begin;                             ///< per node, its first row in K
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();  ///< N_pp^-1; zero where rays are parallel
  Eigen::MatrixXd K;                                  ///< N_xp N_pp^-1, k x 3
  Eigen::MatrixXd N;                                  ///< of the nodes, the point eliminated, k x k
  double smallest_pivot = 0.0;                        ///< of N_pp, scaled: near 0 where its rays are parallel
};

class BlockNormals {
 public:
  /// Must not outlive `linear`.
  explicit BlockNormals(const LinearBlock& linear);

  PointPart part(size_t point) const;
  /// Of the nodes, all points eliminated.
  NodeMatrix reduced() const;
  /// Its observations, by number.
  const std::vector<std::uint32_t>& observations_of(size_t point) const { return of_point_[point]; }
  /// Those without a point.
  const std::vector<std::uint32_t>& others() const { return others_; }
  const LinearBlock& linear() const { return *linear_; }
  /// Nodes that an observation touches, rising.
  std::vector<int> nodes_of(const BlockObservation& o) const;
  /// A row's derivatives by the unknowns of `nodes` (their places in `begin`) and by the point.
  void row_of(size_t row, const std::vector<int>& nodes, const std::vector<int>& begin, Eigen::VectorXd& by_nodes,
              Eigen::Vector3d& by_point) const;
  /// Place of each node's first unknown when they follow one another, and the sum of their sizes at the end.
  std::vector<int> begins(const std::vector<int>& nodes) const;

 private:
  const LinearBlock* linear_;
  std::vector<std::vector<std::uint32_t>> of_point_;
  std::vector<std::uint32_t> others_;
};

}  // namespace swath::calib
