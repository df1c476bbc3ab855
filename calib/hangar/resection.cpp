// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Jubanski et al., eq 9 (parametric adjustment of a station from distances). The paper starts from values read off a drawing; here
// they are computed on both sides of the plane of the targets, because from the wrong side the adjustment ends in the mirror image. Whether
// the linear model, and with it the sigmas, holds: relative curvature (Bates & Watts, "Relative curvature measures of nonlinearity", 1980).
// Ceres was weighed: three unknowns, but curvature, redundancy and the mirror solution need the Jacobians at every step, which it keeps to
// itself.
#include "calib/hangar/resection.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int max_iterations = 100;
constexpr double resection_converged = 1e-10;  // m
constexpr double same_position = 1e-6;         // m; two searches that ended here ended in one minimum
constexpr double in_line_share = 1e-3;         // breadth of the targets by their length
constexpr double least_rise = 0.02;            // of the targets' extent: start off their plane, where the normal matrix is regular
constexpr double equal_resection = 25.0;       // five sigmas between two sums of squares
constexpr size_t least_for_scale = 6;

struct Search {
  bool found = false;
  Vector3d position = Vector3d::Zero();
  double squares = std::numeric_limits<double>::infinity();
};

double squares_at(const std::vector<TargetDistance>& all, const Vector3d& x) {
  double sum = 0;
  for (const TargetDistance& d : all) sum += std::pow((d.distance - (x - d.target).norm()) / d.sigma, 2);
  return sum;
}

Matrix3d normal_matrix(const std::vector<TargetDistance>& all, const Vector3d& x) {
  Matrix3d N = Matrix3d::Zero();
  for (const TargetDistance& d : all) {
    const Eigen::RowVector3d a = distance_model(x, d.target).by_station / d.sigma;
    N += a.transpose() * a;
  }
  return N;
}

/// Gauss-Newton with halved steps.
Search search(const std::vector<TargetDistance>& all, const Vector3d& start) {
  Search out;
  out.position = start;
  out.squares = squares_at(all, start);
  for (int k = 0; k < max_iterations; ++k) {
    Vector3d right = Vector3d::Zero();
    for (const TargetDistance& d : all) {
      const DistanceModel m = distance_model(out.position, d.target);
      right += m.by_station.transpose() * (d.distance - m.distance) / (d.sigma * d.sigma);
    }
    Vector3d step = normal_matrix(all, out.position).completeOrthogonalDecomposition().solve(right);
    if (!step.allFinite()) return out;
    double squares = squares_at(all, out.position + step);
    while (squares > out.squares && step.norm() > resection_converged) {
      step /= 2;
      squares = squares_at(all, out.position + step);
    }
    if (step.norm() <= resection_converged) {
      out.found = true;
      if (squares <= out.squares) out.position += step;
      out.squares = std::min(squares, out.squares);
      return out;
    }
    out.position += step;
    out.squares = squares;
  }
  return out;
}

struct Shape {
  Vector3d centre;
  Matrix3d axes;    ///< columns: normal of the plane, breadth, length
  Vector3d extent;  ///< rms along them, m
};

Shape shape_of(const std::vector<TargetDistance>& all) {
  Shape s;
  s.centre.setZero();
  for (const TargetDistance& d : all) s.centre += d.target / static_cast<double>(all.size());
  Matrix3d scatter = Matrix3d::Zero();
  for (const TargetDistance& d : all)
    scatter += (d.target - s.centre) * (d.target - s.centre).transpose() / static_cast<double>(all.size());
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(scatter);
  s.axes = solver.eigenvectors();
  s.extent = solver.eigenvalues().cwiseMax(0).cwiseSqrt();
  return s;
}

/// Start values: within the plane from differences of squared distances, off the plane on both sides; and, where the targets fill space,
/// the same without a plane.
std::vector<Vector3d> start_values(const std::vector<TargetDistance>& all, const Shape& shape) {
  const auto n = static_cast<Eigen::Index>(all.size());
  MatrixXd t(n, 3);
  VectorXd right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const TargetDistance& d = all[static_cast<size_t>(i)];
    t.row(i) = (shape.axes.transpose() * (d.target - shape.centre)).transpose();
    right[i] = (t.row(i).squaredNorm() - d.distance * d.distance) / 2;
  }
  right.array() -= right.mean();
  const Eigen::Vector2d in_plane = t.rightCols<2>().colPivHouseholderQr().solve(right);
  double rise_squared = 0;
  for (Eigen::Index i = 0; i < n; ++i)
    rise_squared += (std::pow(all[static_cast<size_t>(i)].distance, 2) - (t.row(i).tail<2>().transpose() - in_plane).squaredNorm()) /
                    static_cast<double>(n);
  const double rise = std::max(std::sqrt(std::max(rise_squared, 0.0)), least_rise * shape.extent[2]);
  std::vector<Vector3d> out;
  for (const double side : {rise, -rise}) out.push_back(shape.centre + shape.axes * Vector3d(side, in_plane[0], in_plane[1]));
  if (n >= 4 && shape.extent[0] > in_line_share * shape.extent[2])
    out.push_back(shape.centre + shape.axes * Vector3d(t.colPivHouseholderQr().solve(right)));
  return out;
}

/// k of (k D)^2 = |x|^2 - 2 t x + |t|^2, linear in k^2, x and |x|^2; what a plane of targets leaves open does not touch k.
double fitted_scale(const std::vector<TargetDistance>& all, const Shape& shape) {
  const auto n = static_cast<Eigen::Index>(all.size());
  MatrixXd A(n, 5);
  VectorXd right(n);
  double mean = 0;
  for (const TargetDistance& d : all) mean += d.distance * d.distance / static_cast<double>(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const TargetDistance& d = all[static_cast<size_t>(i)];
    const Vector3d t = d.target - shape.centre;
    A.row(i) << 2 * t.transpose() / shape.extent[2], -1, d.distance * d.distance / mean;
    right[i] = t.squaredNorm();
  }
  const double k2 = A.completeOrthogonalDecomposition().solve(right)[4] / mean;
  return k2 > 0 ? std::sqrt(k2) : std::numeric_limits<double>::quiet_NaN();
}

void judge(const std::vector<TargetDistance>& all, double squares, Resection& out) {
  out.covariance = normal_matrix(all, out.position).inverse();
  out.redundancy = static_cast<int>(all.size()) - 3;
  if (out.redundancy > 0) out.variance_factor = squares / out.redundancy;
  constexpr double least_redundancy = 1e-6;
  for (const TargetDistance& d : all) {
    const DistanceModel m = distance_model(out.position, d.target);
    out.residual.push_back(d.distance - m.distance);
    const double r = 1 - (m.by_station * out.covariance).dot(m.by_station) / (d.sigma * d.sigma);
    out.w.push_back(r > least_redundancy ? out.residual.back() / (d.sigma * std::sqrt(r)) : 0.0);
  }
}

}  // namespace

DistanceModel distance_model(const Vector3d& station, const Vector3d& target) {
  const Vector3d d = station - target;
  const double length = d.norm();
  return {length, length > 0 ? Eigen::RowVector3d(d.transpose() / length) : Eigen::RowVector3d::Zero()};
}

Resection resect(const std::vector<TargetDistance>& all, const std::optional<Vector3d>& start) {
  Resection out;
  if (all.size() < 3) {
    out.state = ResectionState::too_few;
    return out;
  }
  const Shape shape = shape_of(all);
  if (shape.extent[1] <= in_line_share * shape.extent[2]) {
    out.state = ResectionState::in_line;
    return out;
  }
  if (all.size() >= least_for_scale) out.scale = fitted_scale(all, shape);

  std::vector<Search> ends;  // distinct minima
  const auto add = [&](const Vector3d& from) {
    const Search s = search(all, from);
    if (s.found &&
        std::none_of(ends.begin(), ends.end(), [&](const Search& e) { return (e.position - s.position).norm() < same_position; }))
      ends.push_back(s);
    return s;
  };
  for (const Vector3d& from : start_values(all, shape)) add(from);
  Search from_start;
  if (start) from_start = add(*start);
  if (ends.empty()) return out;

  std::sort(ends.begin(), ends.end(), [](const Search& a, const Search& b) { return a.squares < b.squares; });
  const bool both_fit = ends.size() > 1 && ends[1].squares - ends[0].squares < equal_resection;
  if (both_fit && start && (ends[1].position - *start).norm() < (ends[0].position - *start).norm()) std::swap(ends[0], ends[1]);
  out.position = ends[0].position;
  judge(all, ends[0].squares, out);
  out.state = ResectionState::solved;
  if (ends.size() > 1) {
    out.mirror = ends[1].position;
    out.mirror_variance_factor = ends[1].squares / std::max(out.redundancy, 1);
    out.start_led_to_mirror = from_start.found && (from_start.position - out.position).norm() > same_position;
  }
  Vector3d moved = Vector3d::Zero();  // a straight model of distances that bend is no model
  const double variance = Eigen::SelfAdjointEigenSolver<Matrix3d>(out.covariance).eigenvalues().maxCoeff();
  for (const TargetDistance& d : all)
    moved += distance_model(out.position, d.target).by_station.transpose() * variance / (2 * d.distance * d.sigma * d.sigma);
  if (!(std::sqrt(moved.dot(out.covariance * moved)) < largest_bend)) {
    out.state = ResectionState::weak;
  } else if (both_fit) {
    out.decided_by_start = start.has_value();
    if (!start) out.state = ResectionState::two_fit;
  }
  return out;
}

}  // namespace swath::calib
