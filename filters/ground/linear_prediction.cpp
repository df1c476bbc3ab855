// SPDX-License-Identifier: GPL-3.0-or-later
// Kraus & Pfeifer 1998, "Determination of terrain models in wooded areas with airborne laser scanner data", ISPRS J. 53.
//
// Deviations:
// - The variance of the heights about the plane, less that of the points, is C(0); the covariance's length is given and not estimated from
//   the points: at the points of one patch its empirical estimate is not better than a guess.
// - The shift g of the weight function is the mean of the negative residuals. The paper finds it in the histogram of residuals; both follow
//   the lower edge of the points as the iterations go on.
// - The plane is held to level by a weak observation (a slope of 0 with a standard deviation of 1), so that few points or points on a line
// give
//   one too. With 40 points of 0.1 m over 7 m its slope changes by a part in 10^5.
#include "filters/ground/linear_prediction.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace swath::filters {
namespace {

constexpr int most_iterations = 6;
constexpr double settled = 0.02;       // largest change of a weight
constexpr double least_weight = 0.01;  // points of less take no part: above three half widths
constexpr double level_sigma = 1.0;    // rise / run

/// Of the heights at (x, y) and at the places of two rows, as a share of the variance.
template <class Places>
auto covariances(const Places& places, double x, double y, double length) {
  return (((places.row(0).array() - x).square() + (places.row(1).array() - y).square()) * (-1.0 / (length * length))).exp();
}

Eigen::Vector3d plane_through(const std::vector<Eigen::Vector3d>& points, const Eigen::VectorXd& weight, double sigma) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (size_t k = 0; k < points.size(); ++k) {
    const Eigen::Vector3d row(1.0, points[k].x(), points[k].y());
    normal += weight[k] * row * row.transpose();
    right += weight[k] * points[k].z() * row;
  }
  const double level = sigma * sigma / (level_sigma * level_sigma);
  normal(1, 1) += level;
  normal(2, 2) += level;
  return normal.ldlt().solve(right);
}

}  // namespace

double PredictedSurface::height(double x, double y) const {
  return plane[0] + plane[1] * x + plane[2] * y + (covariances(places, x, y, length) * factors.transpose().array()).sum();
}

double one_sided_weight(double above, double shift, double half_width) {
  if (above <= shift) return 1.0;
  const double u = (above - shift) / half_width;  // half_width = 1 / a; b = 4
  const double weight = 1.0 / (1.0 + u * u * u * u);
  return weight < least_weight ? 0.0 : weight;
}

PredictedSurface predict_robustly(const std::vector<Eigen::Vector3d>& points, const PredictionModel& model) {
  PredictedSurface s;
  s.length = model.length;
  const auto n = static_cast<Eigen::Index>(points.size());
  if (n == 0) return s;
  decltype(s.places) all(2, n);
  for (Eigen::Index k = 0; k < n; ++k) all.col(k) = points[static_cast<size_t>(k)].head<2>();
  Eigen::MatrixXd correlation(n, n);
  for (Eigen::Index k = 0; k < n; ++k) correlation.col(k) = covariances(all, all(0, k), all(1, k), model.length).transpose();

  Eigen::VectorXd weight = Eigen::VectorXd::Ones(n);
  const double variance = model.sigma * model.sigma;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    s.plane = plane_through(points, weight, model.sigma);
    Eigen::VectorXd about_plane(n);
    for (Eigen::Index k = 0; k < n; ++k) about_plane[k] = points[k].z() - s.plane.dot(Eigen::Vector3d(1.0, points[k].x(), points[k].y()));
    const double spread = (weight.array() * about_plane.array().square()).sum() / weight.sum();
    const double signal = std::max(spread - variance, variance);  // C(0)

    std::vector<Eigen::Index> taken;
    for (Eigen::Index k = 0; k < n; ++k)
      if (weight[k] > 0) taken.push_back(k);
    Eigen::MatrixXd c = signal * correlation(taken, taken);
    c.diagonal() += variance * weight(taken).cwiseInverse();
    s.factors = signal * c.llt().solve(Eigen::VectorXd(about_plane(taken)));  // Kraus1998 eq 3
    s.places.resize(2, static_cast<Eigen::Index>(taken.size()));
    for (size_t k = 0; k < taken.size(); ++k) s.places.col(static_cast<Eigen::Index>(k)) = points[taken[k]].head<2>();

    const Eigen::VectorXd residual = about_plane - correlation(Eigen::all, taken) * s.factors;
    double sum = 0, count = 0;
    for (Eigen::Index k = 0; k < n; ++k)
      if (residual[k] < 0) sum += residual[k], ++count;
    const double shift = count > 0 ? sum / count : 0.0;
    double change = 0;
    for (Eigen::Index k = 0; k < n; ++k) {
      const double w = one_sided_weight(residual[k], shift, model.half_width);
      change = std::max(change, std::abs(w - weight[k]));
      weight[k] = w;
    }
    if (change < settled || weight.sum() == 0) break;
  }
  return s;
}

}  // namespace swath::filters
