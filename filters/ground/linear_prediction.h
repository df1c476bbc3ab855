// SPDX-License-Identifier: GPL-3.0-or-later
// Robust linear prediction of a surface from points on and above it: Kraus & Pfeifer 1998, ISPRS J. 53, 193-203.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace swath::filters {

struct PredictionModel {
  double sigma = 0.1;       ///< m, standard deviation of a ground point about the surface
  double half_width = 0.3;  ///< m above the lowest ground points where the weight of a point is one half
  double length = 2.0;      ///< m at which the covariance of two heights is 1/e of the variance
};

/// A surface: a plane and the covariances with the points.
struct PredictedSurface {
  Eigen::Vector3d plane = Eigen::Vector3d::Zero();                   ///< height at (0, 0), rise along x, rise along y
  Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor> places;  ///< of the points that carry it, m
  Eigen::VectorXd factors;                                           ///< per point, m
  double length = 1.0;                                               ///< m, as in the model

  bool empty() const { return places.cols() == 0; }
  double height(double x, double y) const;
};

/// The weight of a point that lies `above` the surface (m; negative below) when the origin is shifted to `shift`. Kraus1998 eq 6.
double one_sided_weight(double above, double shift, double half_width);

/// The surface through the lower points of `points` (coordinates from a place near their middle); empty for no points. The order of the
/// points decides only rounding.
PredictedSurface predict_robustly(const std::vector<Eigen::Vector3d>& points, const PredictionModel& model);

}  // namespace swath::filters
