// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/node_matrix.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace swath::calib {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
constexpr double least_pivot = 1e-13;

std::vector<int> firsts(const std::vector<int>& sizes) {
  std::vector<int> out{0};
  for (const int s : sizes) out.push_back(out.back() + s);
  return out;
}

/// The nodes in an order that keeps fronts small.
std::vector<int> minimum_degree(const std::vector<std::vector<int>>& neighbours) {
  const auto n = static_cast<int>(neighbours.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (int a = 0; a < n; ++a) {
    entries.emplace_back(a, a, 1.0);
    for (const int b : neighbours[static_cast<size_t>(a)]) entries.emplace_back(a, b, 1.0);
  }
  Eigen::SparseMatrix<double> pattern(n, n);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> p;
  Eigen::AMDOrdering<int>()(pattern, p);
  return {p.indices().data(), p.indices().data() + n};
}

/// Of each place the places below it that its elimination touches; the first of them is its parent.
std::vector<std::vector<int>> fronts_of(const std::vector<std::vector<int>>& neighbours, const std::vector<int>& order) {
  const size_t n = order.size();
  std::vector<int> place(n);
  for (size_t k = 0; k < n; ++k) place[static_cast<size_t>(order[k])] = static_cast<int>(k);
  std::vector<std::vector<int>> below(n), children(n);
  for (size_t k = 0; k < n; ++k) {
    std::vector<int>& mine = below[k];
    for (const int b : neighbours[static_cast<size_t>(order[k])])
      if (place[static_cast<size_t>(b)] > static_cast<int>(k)) mine.push_back(place[static_cast<size_t>(b)]);
    for (const int child : children[k])
      for (const int p : below[static_cast<size_t>(child)])
        if (p > static_cast<int>(k)) mine.push_back(p);
    std::sort(mine.begin(), mine.end());
    mine.erase(std::unique(mine.begin(), mine.end()), mine.end());
    if (!mine.empty()) children[static_cast<size_t>(mine.front())].push_back(static_cast<int>(k));
  }
  return below;
}

/// The same elimination in an order where each subtree lies together, so that few fronts are held at a time.
std::vector<int> depth_first(const std::vector<std::vector<int>>& below, const std::vector<int>& order) {
  const size_t n = order.size();
  std::vector<std::vector<int>> children(n);
  std::vector<int> todo, reversed;
  for (size_t k = 0; k < n; ++k) {
    if (below[k].empty())
      todo.push_back(static_cast<int>(k));
    else
      children[static_cast<size_t>(below[k].front())].push_back(static_cast<int>(k));
  }
  while (!todo.empty()) {
    const int k = todo.back();
    todo.pop_back();
    reversed.push_back(order[static_cast<size_t>(k)]);
    for (const int c : children[static_cast<size_t>(k)]) todo.push_back(c);
  }
  return {reversed.rbegin(), reversed.rend()};
}

/// Cholesky factor of the lower triangle in place; pivots that are too small are replaced. Returns the smallest.
double cholesky(Eigen::Ref<MatrixXd> A) {
  double smallest = 1.0;
  for (Eigen::Index j = 0; j < A.rows(); ++j) {
    double squares = 0.0;
    for (Eigen::Index k = 0; k < j; ++k) squares += A(j, k) * A(j, k);
    const double pivot = A(j, j) - squares;
    const double used = pivot > least_pivot ? pivot : least_pivot;
    smallest = std::min(smallest, used);
    A(j, j) = std::sqrt(used);
    for (Eigen::Index i = j + 1; i < A.rows(); ++i) A(i, j) = (A(i, j) - A.row(i).head(j).dot(A.row(j).head(j))) / A(j, j);
    A.col(j).head(j).setZero();
  }
  return smallest;
}

}  // namespace

NodeMatrix::NodeMatrix(std::vector<int> sizes) : sizes_(std::move(sizes)), first_(firsts(sizes_)) {}

void NodeMatrix::add(int a, int b, const Eigen::Ref<const MatrixXd>& M) {
  if (a < b) return add(b, a, M.transpose());
  const auto n = static_cast<size_t>(size(a)) * static_cast<size_t>(size(b));
  const auto [it, is_new] = at_.try_emplace(key(a, b), values_.size());
  if (is_new) values_.resize(values_.size() + n, 0.0);
  Eigen::Map<MatrixXd>(values_.data() + it->second, size(a), size(b)) += M;
}

Eigen::Map<const MatrixXd> NodeMatrix::block(int a, int b) const {
  const auto it = at_.find(key(a, b));
  if (it == at_.end()) return {nullptr, 0, 0};
  return {values_.data() + it->second, size(a), size(b)};
}

std::vector<std::vector<int>> NodeMatrix::neighbours() const {
  std::vector<std::vector<int>> out(sizes_.size());
  for (const auto& [pair, where] : at_) {
    const auto a = static_cast<int>(pair >> 32), b = static_cast<int>(pair & 0xffffffffu);
    if (a == b) continue;
    out[static_cast<size_t>(a)].push_back(b);
    out[static_cast<size_t>(b)].push_back(a);
  }
  for (auto& list : out) std::sort(list.begin(), list.end());  // the map's own order is not to matter
  return out;
}

VectorXd NodeMatrix::diagonal() const {
  VectorXd d = VectorXd::Zero(unknowns());
  for (int a = 0; a < nodes(); ++a)
    if (const auto A = block(a, a); A.size() > 0) d.segment(first(a), size(a)) = A.diagonal();
  return d;
}

NodeFactor::NodeFactor(const NodeMatrix& matrix, double shift) {
  scale_ = matrix.diagonal();
  for (double& s : scale_) s = s > 0.0 ? 1.0 / std::sqrt(s) : 1.0;
  order(matrix);
  factorise(matrix, shift);
}

void NodeFactor::order(const NodeMatrix& matrix) {
  const auto neighbours = matrix.neighbours();
  std::vector<int> nodes = minimum_degree(neighbours);
  nodes = depth_first(fronts_of(neighbours, nodes), nodes);
  const auto below = fronts_of(neighbours, nodes);
  place_.resize(nodes.size());
  fronts_.resize(nodes.size());
  for (size_t k = 0; k < nodes.size(); ++k) {
    place_[static_cast<size_t>(nodes[k])] = static_cast<int>(k);
    sizes_.push_back(matrix.size(nodes[k]));
    first_of_node_.push_back(matrix.first(nodes[k]));
  }
  first_ = firsts(sizes_);
  for (size_t k = 0; k < nodes.size(); ++k) {
    Front& f = fronts_[k];
    f.node = nodes[k];
    f.below = below[k];
    f.parent = f.below.empty() ? -1 : f.below.front();
    for (const int p : f.below) f.rows += size_at(p);
  }
}

int NodeFactor::row_in(const Front& front, int place) const {
  int row = 0;
  for (const int p : front.below) {
    if (p == place) return row;
    row += size_at(p);
  }
  throw std::logic_error("two nodes without a common front");
}

void NodeFactor::factorise(const NodeMatrix& matrix, double shift) {
  std::vector<std::vector<int>> children(fronts_.size());
  std::vector<MatrixXd> rest(fronts_.size());  // what an elimination leaves to those below
  for (size_t k = 0; k < fronts_.size(); ++k) {
    Front& f = fronts_[k];
    const int own = size_at(static_cast<int>(k));
    MatrixXd A = MatrixXd::Zero(own + f.rows, own + f.rows);
    const auto scaled = [&](int row_node, int column_node) -> MatrixXd {
      const bool lower = row_node >= column_node;
      const auto B = lower ? matrix.block(row_node, column_node) : matrix.block(column_node, row_node);
      if (B.size() == 0) return {};
      const auto s_r = scale_.segment(matrix.first(row_node), matrix.size(row_node));
      const auto s_c = scale_.segment(matrix.first(column_node), matrix.size(column_node));
      if (lower) return s_r.asDiagonal() * B * s_c.asDiagonal();
      return s_r.asDiagonal() * B.transpose() * s_c.asDiagonal();
    };
    if (const MatrixXd D = scaled(f.node, f.node); D.size() > 0) A.topLeftCorner(own, own) = D;
    A.topLeftCorner(own, own).diagonal().array() += shift;
    int row = own;
    for (const int p : f.below) {
      if (const MatrixXd B = scaled(fronts_[static_cast<size_t>(p)].node, f.node); B.size() > 0) A.block(row, 0, size_at(p), own) = B;
      row += size_at(p);
    }
    for (const int c : children[k]) {
      const Front& child = fronts_[static_cast<size_t>(c)];
      MatrixXd& R = rest[static_cast<size_t>(c)];
      std::vector<int> to;  // rows of the child's rest in this front
      for (const int p : child.below) {
        const int begin = p == static_cast<int>(k) ? 0 : own + row_in(f, p);
        for (int i = 0; i < size_at(p); ++i) to.push_back(begin + i);
      }
      for (Eigen::Index j = 0; j < R.cols(); ++j)
        for (Eigen::Index i = j; i < R.rows(); ++i) A(to[static_cast<size_t>(i)], to[static_cast<size_t>(j)]) += R(i, j);
      R.resize(0, 0);
    }
    smallest_pivot_ = std::min(smallest_pivot_, cholesky(A.topLeftCorner(own, own)));
    f.L11 = A.topLeftCorner(own, own);
    f.L21 = A.bottomLeftCorner(f.rows, own);
    f.L11.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(f.L21);
    rest[k] = A.bottomRightCorner(f.rows, f.rows);
    rest[k].selfadjointView<Eigen::Lower>().rankUpdate(f.L21, -1.0);
    if (f.parent >= 0) children[static_cast<size_t>(f.parent)].push_back(static_cast<int>(k));
  }
}

MatrixXd NodeFactor::solve(const MatrixXd& b) const {
  std::vector<MatrixXd> x(fronts_.size());
  const auto s = [&](size_t k) { return scale_.segment(first_of_node_[k], size_at(static_cast<int>(k))); };
  for (size_t k = 0; k < fronts_.size(); ++k) x[k] = s(k).asDiagonal() * b.middleRows(first_of_node_[k], size_at(static_cast<int>(k)));
  for (size_t k = 0; k < fronts_.size(); ++k) {
    const Front& f = fronts_[k];
    f.L11.triangularView<Eigen::Lower>().solveInPlace(x[k]);
    int row = 0;
    for (const int p : f.below) {
      x[static_cast<size_t>(p)] -= f.L21.middleRows(row, size_at(p)) * x[k];
      row += size_at(p);
    }
  }
  for (size_t k = fronts_.size(); k-- > 0;) {
    const Front& f = fronts_[k];
    int row = 0;
    for (const int p : f.below) {
      x[k] -= f.L21.middleRows(row, size_at(p)).transpose() * x[static_cast<size_t>(p)];
      row += size_at(p);
    }
    f.L11.triangularView<Eigen::Lower>().transpose().solveInPlace(x[k]);
  }
  MatrixXd out(b.rows(), b.cols());
  for (size_t k = 0; k < fronts_.size(); ++k) out.middleRows(first_of_node_[k], size_at(static_cast<int>(k))) = s(k).asDiagonal() * x[k];
  return out;
}

void NodeFactor::invert(Keep keep) {
  std::vector<MatrixXd> whole(fronts_.size());  // of the inverse over a front, while it has children to come
  std::vector<int> waiting(fronts_.size(), 0);
  for (const Front& f : fronts_)
    if (f.parent >= 0) ++waiting[static_cast<size_t>(f.parent)];
  for (size_t k = fronts_.size(); k-- > 0;) {
    Front& f = fronts_[k];
    const int own = size_at(static_cast<int>(k));
    MatrixXd Z(own + f.rows, own + f.rows);
    if (f.parent >= 0) {
      const auto parent = static_cast<size_t>(f.parent);
      std::vector<int> from;
      for (const int p : f.below) {
        const int begin = p == f.parent ? 0 : size_at(f.parent) + row_in(fronts_[parent], p);
        for (int i = 0; i < size_at(p); ++i) from.push_back(begin + i);
      }
      Z.bottomRightCorner(f.rows, f.rows) = whole[parent](from, from);
      if (--waiting[parent] == 0) whole[parent].resize(0, 0);
    }
    MatrixXd K = f.L21;
    f.L11.triangularView<Eigen::Lower>().solveInPlace<Eigen::OnTheRight>(K);
    const MatrixXd inverse = f.L11.triangularView<Eigen::Lower>().solve(MatrixXd::Identity(own, own));
    f.Z21.noalias() = -Z.bottomRightCorner(f.rows, f.rows) * K;
    f.Z11 = inverse.transpose() * inverse - K.transpose() * f.Z21;
    Z.topLeftCorner(own, own) = f.Z11;
    Z.bottomLeftCorner(f.rows, own) = f.Z21;
    Z.topRightCorner(own, f.rows) = f.Z21.transpose();
    if (waiting[k] > 0) whole[k] = std::move(Z);
    if (keep == Keep::inverse_alone) f.L11.resize(0, 0), f.L21.resize(0, 0);
  }
}

MatrixXd NodeFactor::block(int a, int b) const {
  if (a == b) return fronts_[static_cast<size_t>(a)].Z11;
  if (a < b) return block(b, a).transpose();
  const Front& f = fronts_[static_cast<size_t>(b)];
  return f.Z21.middleRows(row_in(f, a), size_at(a));
}

MatrixXd NodeFactor::covariance(const std::vector<int>& nodes) const {
  std::vector<int> first{0}, place;
  for (const int n : nodes) {
    place.push_back(place_[static_cast<size_t>(n)]);
    first.push_back(first.back() + size_at(place.back()));
  }
  MatrixXd C(first.back(), first.back());
  for (size_t i = 0; i < nodes.size(); ++i)
    for (size_t j = 0; j <= i; ++j) {
      const auto of = [&](size_t k) { return scale_.segment(first_of_node_[static_cast<size_t>(place[k])], size_at(place[k])); };
      const MatrixXd B = of(i).asDiagonal() * block(place[i], place[j]) * of(j).asDiagonal();
      C.block(first[i], first[j], B.rows(), B.cols()) = B;
      C.block(first[j], first[i], B.cols(), B.rows()) = B.transpose();
    }
  return C;
}

}  // namespace swath::calib
