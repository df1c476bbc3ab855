// SPDX-License-Identifier: GPL-3.0-or-later
// With the point p of a row (a_x, a_p) eliminated, K = N_xp N_pp^-1 and C_xx the covariance of the nodes:
//   b = a_x - K a_p,  variance of the adjusted observation = a_p' N_pp^-1 a_p + b' C_xx b,  C_pp = N_pp^-1 + K' C_xx K.
#include "calib/block/block_inference.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double least_redundancy = 1e-6;  // below it a residual says nothing

/// Redundancy and w of one row whose adjusted value has the variance `h` (of the row's unit).
void judge_row(BlockInference& out, const LinearBlock& l, size_t row, double h) {
  const double r = std::clamp(1.0 - h, 0.0, 1.0);
  out.redundancy[row] = static_cast<float>(r);
  if (r > least_redundancy) out.w[row] = static_cast<float>(l.residual[row] / std::sqrt(r));
}

void judge_point(BlockInference& out, const BlockNormals& normals, const NodeFactor& factor, size_t point) {
  const LinearBlock& l = normals.linear();
  const PointPart part = normals.part(point);
  const MatrixXd C = factor.covariance(part.nodes);
  const Eigen::Matrix<double, Eigen::Dynamic, 3> CK = C * part.K;
  out.points[point] = part.inverse + part.K.transpose() * CK;
  VectorXd a, b;
  Vector3d p;
  for (const std::uint32_t o : normals.observations_of(point)) {
    const BlockObservation& observation = l.observations[o];
    for (size_t row = observation.row; row < observation.row + static_cast<size_t>(observation.rows); ++row) {
      normals.row_of(row, part.nodes, part.begin, a, p);
      b = a - part.K * p;
      const Vector3d through = part.inverse * p;
      judge_row(out, l, row, p.dot(through) + b.dot(C * b));
      const double r = static_cast<double>(out.redundancy[row]);
      // An error of one unit of the row moves the point by C a'.
      if (r > least_redundancy) out.outer[row] = static_cast<float>((through - CK.transpose() * b).norm() * delta0 / std::sqrt(r));
    }
  }
}

/// Image points without weight have nearly all of their redundancy and no square: with them every sigma would come out too small.
void add_sums(const LinearBlock& linear, const std::vector<double>& of_ray, BlockInference& out) {
  for (const BlockObservation& o : linear.observations) {
    const bool lost = o.kind == ObservationKind::ray && !of_ray.empty() && of_ray[o.index] <= no_ray_weight;
    for (size_t row = o.row; row < o.row + static_cast<size_t>(o.rows); ++row) {
      const double r = static_cast<double>(out.redundancy[row]);
      if (lost) {
        out.redundancy_lost += r;
        continue;
      }
      out.redundancy_of[static_cast<size_t>(o.kind)] += r;
      out.squares_of[static_cast<size_t>(o.kind)] += linear.residual[row] * linear.residual[row];
    }
  }
}

/// Covariances of images with their cameras, which the factor's pattern has where a ray has both.
void add_cameras(const BlockNormals& normals, const NodeFactor& factor, BlockInference& out) {
  const LinearBlock& l = normals.linear();
  out.with_camera.resize(l.nodes.size());
  out.camera_of.assign(l.nodes.size(), -1);
  for (const BlockObservation& o : l.observations) {
    if (o.kind != ObservationKind::ray) continue;
    int image = -1, camera = -1;
    for (const int n : normals.nodes_of(o)) {
      if (l.nodes[static_cast<size_t>(n)].kind == NodeKind::image) image = n;
      if (l.nodes[static_cast<size_t>(n)].kind == NodeKind::camera) camera = n;
    }
    if (image < 0 || camera < 0 || out.camera_of[static_cast<size_t>(image)] >= 0) continue;
    const MatrixXd both = factor.covariance({image, camera});
    const Eigen::Index own = out.nodes[static_cast<size_t>(image)].rows();
    out.with_camera[static_cast<size_t>(image)] = both.topRightCorner(own, both.cols() - own);
    out.camera_of[static_cast<size_t>(image)] = camera;
  }
}

}  // namespace

BlockInference infer(const LinearBlock& linear, const std::vector<double>& of_ray) {
  const BlockNormals normals(linear);
  BlockInference out;
  NodeFactor factor(normals.reduced());
  out.smallest_pivot = factor.smallest_pivot();
  for (std::uint32_t p = 0; p < linear.point_column.size(); ++p)
    if (linear.point_column[p] >= 0 && !(normals.part(p).smallest_pivot > parallel_rays)) out.unsound_points.push_back(p);
  if (!out.determined() || !out.unsound_points.empty()) return out;
  factor.invert();
  for (int n = 0; n < static_cast<int>(linear.nodes.size()); ++n) out.nodes.push_back(factor.covariance({n}));
  add_cameras(normals, factor, out);
  out.points.assign(linear.point_column.size(), Matrix3d::Zero());
  out.redundancy.assign(linear.residual.size(), 0.0f);
  out.w = out.outer = out.redundancy;
  constexpr size_t grain = 256;
  core::in_parallel(linear.point_column.size(), grain, [&](size_t first, size_t last) {
    for (size_t p = first; p < last; ++p)
      if (linear.point_column[p] >= 0) judge_point(out, normals, factor, p);
  });
  VectorXd a;
  Vector3d none;
  for (const std::uint32_t o : normals.others()) {
    const BlockObservation& observation = linear.observations[o];
    const auto nodes = normals.nodes_of(observation);
    const MatrixXd C = factor.covariance(nodes);
    for (size_t row = observation.row; row < observation.row + static_cast<size_t>(observation.rows); ++row) {
      normals.row_of(row, nodes, normals.begins(nodes), a, none);
      judge_row(out, linear, row, a.dot(C * a));
    }
  }
  add_sums(linear, of_ray, out);
  return out;
}

}  // namespace swath::calib
