// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_normals.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Smallest pivot of a 3 x 3 scaled to a unit diagonal; 0 where a coordinate has no observation.
double smallest_pivot_of(const Matrix3d& N) {
  if (!(N.diagonal().minCoeff() > 0.0)) return 0.0;
  const Vector3d s = N.diagonal().cwiseSqrt().cwiseInverse();
  return (s.asDiagonal() * N * s.asDiagonal()).ldlt().vectorD().minCoeff();
}

}  // namespace

BlockNormals::BlockNormals(const LinearBlock& linear) : linear_(&linear), of_point_(linear.point_column.size()) {
  std::vector<size_t> at(3 * static_cast<size_t>(linear.points()), 0);
  for (size_t p = 0; p < linear.point_column.size(); ++p)
    if (linear.point_column[p] >= 0) at[static_cast<size_t>(linear.point_column[p] - linear.unknowns)] = p;
  for (std::uint32_t o = 0; o < linear.observations.size(); ++o) {
    int last = -1;
    for (size_t k = linear.first[linear.observations[o].row]; k < linear.first[linear.observations[o].row + 1]; ++k)
      last = std::max(last, linear.column[k]);
    if (last < linear.unknowns)
      others_.push_back(o);
    else
      of_point_[at[static_cast<size_t>((last - linear.unknowns) / 3 * 3)]].push_back(o);
  }
}

std::vector<int> BlockNormals::nodes_of(const BlockObservation& o) const {
  std::vector<int> out;
  for (size_t k = linear_->first[o.row]; k < linear_->first[o.row + static_cast<size_t>(o.rows)]; ++k)
    if (linear_->column[k] < linear_->unknowns) out.push_back(linear_->node_of[static_cast<size_t>(linear_->column[k])]);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::vector<int> BlockNormals::begins(const std::vector<int>& nodes) const {
  std::vector<int> out{0};
  for (const int n : nodes) out.push_back(out.back() + static_cast<int>(linear_->nodes[static_cast<size_t>(n)].components.size()));
  return out;
}

void BlockNormals::row_of(size_t row, const std::vector<int>& nodes, const std::vector<int>& begin, VectorXd& by_nodes,
                          Vector3d& by_point) const {
  by_nodes.setZero(begin.back());
  by_point.setZero();
  for (size_t k = linear_->first[row]; k < linear_->first[row + 1]; ++k) {
    const int column = linear_->column[k];
    if (column >= linear_->unknowns) {
      by_point[(column - linear_->unknowns) % 3] = linear_->value[k];
      continue;
    }
    const int node = linear_->node_of[static_cast<size_t>(column)];
    const auto place = static_cast<size_t>(std::lower_bound(nodes.begin(), nodes.end(), node) - nodes.begin());
    by_nodes[begin[place] + column - linear_->nodes[static_cast<size_t>(node)].first] = linear_->value[k];
  }
}

PointPart BlockNormals::part(size_t point) const {
  PointPart out;
  for (const std::uint32_t o : of_point_[point]) {
    const auto touched = nodes_of(linear_->observations[o]);
    out.nodes.insert(out.nodes.end(), touched.begin(), touched.end());
  }
  std::sort(out.nodes.begin(), out.nodes.end());
  out.nodes.erase(std::unique(out.nodes.begin(), out.nodes.end()), out.nodes.end());
  out.begin = begins(out.nodes);
  const int k = out.begin.back();
  out.N = MatrixXd::Zero(k, k);
  MatrixXd N_xp = MatrixXd::Zero(k, 3);
  Matrix3d N_pp = Matrix3d::Zero();
  std::vector<int> nodes, begin;
  VectorXd a;
  Vector3d b;
  for (const std::uint32_t o : of_point_[point]) {
    const BlockObservation& observation = linear_->observations[o];
    nodes = nodes_of(observation);
    begin = begins(nodes);
    for (size_t row = observation.row; row < observation.row + static_cast<size_t>(observation.rows); ++row) {
      row_of(row, nodes, begin, a, b);
      N_pp += b * b.transpose();
      for (size_t i = 0; i < nodes.size(); ++i) {
        const auto to = [&](size_t n) {
          return out.begin[static_cast<size_t>(std::lower_bound(out.nodes.begin(), out.nodes.end(), nodes[n]) - out.nodes.begin())];
        };
        const auto a_i = a.segment(begin[i], begin[i + 1] - begin[i]);
        N_xp.middleRows(to(i), a_i.size()) += a_i * b.transpose();
        for (size_t j = 0; j < nodes.size(); ++j) {
          const auto a_j = a.segment(begin[j], begin[j + 1] - begin[j]);
          out.N.block(to(i), to(j), a_i.size(), a_j.size()) += a_i * a_j.transpose();
        }
      }
    }
  }
  out.smallest_pivot = smallest_pivot_of(N_pp);
  if (out.smallest_pivot > parallel_rays) out.inverse = N_pp.inverse();
  out.K = N_xp * out.inverse;
  out.N.noalias() -= out.K * N_xp.transpose();
  return out;
}

NodeMatrix BlockNormals::reduced() const {
  std::vector<int> sizes;
  for (const UnknownNode& n : linear_->nodes) sizes.push_back(static_cast<int>(n.components.size()));
  NodeMatrix out(sizes);
  const auto add = [&](const std::vector<int>& nodes, const std::vector<int>& begin, const MatrixXd& N) {
    for (size_t i = 0; i < nodes.size(); ++i)
      for (size_t j = 0; j <= i; ++j)
        out.add(nodes[i], nodes[j], N.block(begin[i], begin[j], begin[i + 1] - begin[i], begin[j + 1] - begin[j]));
  };
  for (size_t p = 0; p < of_point_.size(); ++p) {
    if (of_point_[p].empty()) continue;
    const PointPart part = this->part(p);
    add(part.nodes, part.begin, part.N);
  }
  VectorXd a;
  Vector3d b;
  for (const std::uint32_t o : others_) {
    const BlockObservation& observation = linear_->observations[o];
    const auto nodes = nodes_of(observation);
    const auto begin = begins(nodes);
    MatrixXd N = MatrixXd::Zero(begin.back(), begin.back());
    for (size_t row = observation.row; row < observation.row + static_cast<size_t>(observation.rows); ++row) {
      row_of(row, nodes, begin, a, b);
      N += a * a.transpose();
    }
    add(nodes, begin, N);
  }
  return out;
}

}  // namespace swath::calib
