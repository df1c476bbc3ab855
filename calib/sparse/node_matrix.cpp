// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/sparse/node_matrix.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "calib/sparse/dense_product.h"
#include "core/parallel.h"

namespace swath::calib {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
constexpr double least_pivot = 1e-13;
constexpr Index panel = 48;                // columns of a front that are eliminated one by one
constexpr Index grain = 64;                // columns of a product that one thread takes at a time
constexpr double wide_product = 4e6;       // multiplications from which a product is shared by threads
constexpr double part_of_the_work = 0.05;  // of all: a subtree with less is one thread's

std::vector<int> firsts(const std::vector<int>& sizes) {
  std::vector<int> out{0};
  for (const int s : sizes) out.push_back(out.back() + s);
  return out;
}

/// Cholesky factor of the lower triangle in place; pivots that are too small are replaced. Returns the smallest.
double cholesky(Eigen::Ref<MatrixXd> A) {
  double smallest = 1.0;
  const Index n = A.rows();
  for (Index j = 0; j < n; ++j) {
    if (j > 0) A.col(j).tail(n - j).noalias() -= A.bottomLeftCorner(n - j, j) * A.row(j).head(j).transpose();
    const double used = A(j, j) > least_pivot ? A(j, j) : least_pivot;
    smallest = std::min(smallest, used);
    A(j, j) = std::sqrt(used);
    A.col(j).tail(n - j - 1) /= A(j, j);
  }
  return smallest;
}

/// work(first, last) for columns, side by side where that pays; the parts are the same either way.
template <class Work>
void by_columns(Index columns, double multiplications, bool shared, const Work& work) {
  if (shared && multiplications > wide_product)
    core::in_parallel(static_cast<size_t>(columns), static_cast<size_t>(grain),
                      [&](size_t first, size_t last) { work(static_cast<Index>(first), static_cast<Index>(last)); });
  else
    for (Index j = 0; j < columns; j += grain) work(j, std::min(columns, j + grain));
}

/// A -= L L^T, its lower triangle.
void subtract_square(Eigen::Ref<MatrixXd> A, const Eigen::Ref<const MatrixXd>& L, bool shared) {
  const Index n = A.rows();
  by_columns(n, 0.5 * static_cast<double>(n * n * L.cols()), shared, [&](Index j, Index end) {
    subtract_product(A.block(j, j, n - j, end - j), MatrixView::of(L.bottomRows(n - j)),
                     MatrixView::of(L.middleRows(j, end - j)).transposed());
  });
}

/// Cholesky factor of the first rows of L, and what it makes of those below. Returns the smallest pivot.
double eliminate(MatrixXd& L, bool shared) {
  double smallest = 1.0;
  const Index own = L.cols();
  for (Index j = 0; j < own; j += panel) {
    const Index width = std::min(panel, own - j), next = j + width, left = L.rows() - next;
    smallest = std::min(smallest, cholesky(L.block(j, j, width, width)));
    auto below = L.block(next, j, left, width);
    L.block(j, j, width, width).triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(below);
    by_columns(own - next, static_cast<double>(left * (own - next) * width), shared, [&](Index k, Index end) {
      subtract_product(L.block(next + k, next + k, left - k, end - k), MatrixView::of(below.bottomRows(left - k)),
                       MatrixView::of(below.middleRows(k, end - k)).transposed());
    });
  }
  L.topRows(own).triangularView<Eigen::StrictlyUpper>().setZero();
  return smallest;
}

}  // namespace

NodeMatrix::NodeMatrix(std::vector<int> sizes) : sizes_(std::move(sizes)), first_(firsts(sizes_)) {}

void NodeMatrix::add(int a, int b, const Eigen::Ref<const MatrixXd>& M) {
  if (a < b) return add(b, a, M.transpose());
  block_for(a, b) += M;
}

Eigen::Map<MatrixXd> NodeMatrix::block_for(int a, int b) {
  const auto n = static_cast<size_t>(size(a)) * static_cast<size_t>(size(b));
  const auto [it, is_new] = at_.try_emplace(key(a, b), values_.size());
  if (is_new) {
    // By a quarter at a time: doubled, the blocks of a long flight would take gigabytes that stay empty.
    if (values_.size() + n > values_.capacity()) values_.reserve(values_.size() + std::max(n, values_.size() / 4));
    values_.resize(values_.size() + n, 0.0);
  }
  return {values_.data() + it->second, size(a), size(b)};
}

Eigen::Map<const MatrixXd> NodeMatrix::block(int a, int b) const {
  const auto it = at_.find(key(a, b));
  if (it == at_.end()) return {nullptr, 0, 0};
  return {values_.data() + it->second, size(a), size(b)};
}

std::vector<std::pair<int, int>> NodeMatrix::blocks() const {
  std::vector<std::pair<int, int>> out;
  out.reserve(at_.size());
  for (const auto& [pair, where] : at_) out.emplace_back(static_cast<int>(pair >> 32), static_cast<int>(pair & 0xffffffffu));
  std::sort(out.begin(), out.end());
  return out;
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
  const Neighbours neighbours = matrix.neighbours();
  std::vector<int> sizes;
  for (int a = 0; a < matrix.nodes(); ++a) sizes.push_back(matrix.size(a));
  order_ = order_of(neighbours, sizes);
  place_.resize(sizes.size());
  front_at_.resize(sizes.size());
  first_ = {0};
  for (size_t k = 0; k < sizes.size(); ++k) {
    const int node = order_.node[k];
    place_[static_cast<size_t>(node)] = static_cast<int>(k);
    first_of_node_.push_back(matrix.first(node));
    first_.push_back(first_.back() + matrix.size(node));
  }
  values_.resize(order_.fronts.size());
  for (size_t k = 0; k < values_.size(); ++k) {
    const NodeFront& f = front(k);
    std::fill(front_at_.begin() + f.first, front_at_.begin() + f.last, static_cast<int>(k));
    int row = f.own;
    for (const int p : f.below) values_[k].row.push_back(std::exchange(row, row + size_at(p)));
  }
  divide_tree();
  factorise(matrix, neighbours, shift);
}

void NodeFactor::divide_tree() {
  const std::vector<int> first = order_.subtrees();
  double all = 0.0;
  std::vector<double> work(values_.size(), 0.0);
  for (size_t k = 0; k < work.size(); ++k) {
    work[k] += front(k).work();
    all += front(k).work();
    if (front(k).parent >= 0) work[static_cast<size_t>(front(k).parent)] += work[k];
  }
  const auto small = [&](size_t k) { return work[k] <= part_of_the_work * all; };
  for (size_t k = 0; k < work.size(); ++k) {
    if (!small(k))
      trunk_.push_back(k);
    else if (front(k).parent < 0 || !small(static_cast<size_t>(front(k).parent)))
      subtrees_.emplace_back(static_cast<size_t>(first[k]), k + 1);
  }
}

void NodeFactor::from_leaves(const std::function<void(size_t, bool)>& work) const {
  core::in_parallel(subtrees_.size(), 1, [&](size_t first, size_t last) {
    for (size_t s = first; s < last; ++s)
      for (size_t k = subtrees_[s].first; k < subtrees_[s].second; ++k) work(k, false);
  });
  for (const size_t k : trunk_) work(k, true);
}

void NodeFactor::from_root(const std::function<void(size_t, bool)>& work) const {
  for (size_t i = trunk_.size(); i-- > 0;) work(trunk_[i], true);
  core::in_parallel(subtrees_.size(), 1, [&](size_t first, size_t last) {
    for (size_t s = first; s < last; ++s)
      for (size_t k = subtrees_[s].second; k-- > subtrees_[s].first;) work(k, false);
  });
}

int NodeFactor::row_in(size_t number, int place) const {
  const NodeFront& f = front(number);
  if (place < f.last) return first_[static_cast<size_t>(place)] - first_[static_cast<size_t>(f.first)];
  const auto found = std::lower_bound(f.below.begin(), f.below.end(), place);
  if (found == f.below.end() || *found != place) throw std::logic_error("two nodes without a common front");
  return values_[number].row[static_cast<size_t>(found - f.below.begin())];
}

std::vector<int> NodeFactor::rows_in_parent(size_t number) const {
  const NodeFront& f = front(number);
  std::vector<int> out;
  out.reserve(static_cast<size_t>(f.rows));
  for (const int p : f.below) {
    const int begin = row_in(static_cast<size_t>(f.parent), p);
    for (int i = 0; i < size_at(p); ++i) out.push_back(begin + i);
  }
  return out;
}

void NodeFactor::place_columns(const NodeMatrix& matrix, const Neighbours& neighbours, size_t number, MatrixXd& L) const {
  const NodeFront& f = front(number);
  for (int p = f.first; p < f.last; ++p) {
    const int node = order_.node[static_cast<size_t>(p)], column = row_in(number, p);
    const auto s_c = scale_.segment(matrix.first(node), matrix.size(node));
    const auto put = [&](int other) {
      const auto B = node <= other ? matrix.block(other, node) : matrix.block(node, other);
      if (B.size() == 0) return;
      const auto s_r = scale_.segment(matrix.first(other), matrix.size(other));
      auto to = L.block(row_in(number, place_[static_cast<size_t>(other)]), column, s_r.size(), s_c.size());
      if (node <= other)
        to = s_r.asDiagonal() * B * s_c.asDiagonal();
      else
        to = s_r.asDiagonal() * B.transpose() * s_c.asDiagonal();
    };
    put(node);
    for (const int other : neighbours[static_cast<size_t>(node)])
      if (place_[static_cast<size_t>(other)] > p) put(other);
  }
}

void NodeFactor::factorise(const NodeMatrix& matrix, const Neighbours& neighbours, double shift) {
  std::vector<std::vector<size_t>> children(values_.size());
  std::vector<MatrixXd> rests(values_.size());  // what an elimination leaves to the fronts below it
  std::vector<double> pivot(values_.size(), 1.0);
  for (size_t k = 0; k < values_.size(); ++k)
    if (front(k).parent >= 0) children[static_cast<size_t>(front(k).parent)].push_back(k);
  from_leaves([&](size_t k, bool alone) {
    const NodeFront& f = front(k);
    MatrixXd& L = values_[k].L;
    L = MatrixXd::Zero(f.own + f.rows, f.own);
    MatrixXd& rest = rests[k] = MatrixXd::Zero(f.rows, f.rows);
    place_columns(matrix, neighbours, k, L);
    L.diagonal().array() += shift;
    for (const size_t c : children[k]) {
      MatrixXd R;
      R.swap(rests[c]);
      const std::vector<int> to = rows_in_parent(c);
      for (Index j = 0; j < R.cols(); ++j) {
        const Index column = to[static_cast<size_t>(j)];
        double* into = column < f.own ? &L(0, column) : &rest(0, column - f.own) - f.own;
        for (Index i = j; i < R.rows(); ++i) into[to[static_cast<size_t>(i)]] += R(i, j);
      }
    }
    pivot[k] = eliminate(L, alone);
    subtract_square(rest, L.bottomRows(f.rows), alone);
  });
  smallest_pivot_ = std::accumulate(pivot.begin(), pivot.end(), 1.0, [](double a, double b) { return std::min(a, b); });
}

MatrixXd NodeFactor::solve(const MatrixXd& b) const {
  MatrixXd x(b.rows(), b.cols());
  const auto s = [&](size_t p) { return scale_.segment(first_of_node_[p], size_at(static_cast<int>(p))); };
  for (size_t p = 0; p < place_.size(); ++p)
    x.middleRows(first_[p], size_at(static_cast<int>(p))) =
        s(p).asDiagonal() * b.middleRows(first_of_node_[p], size_at(static_cast<int>(p)));
  const auto own = [&](size_t k) { return x.middleRows(first_[static_cast<size_t>(front(k).first)], front(k).own); };
  const auto each_below = [&](size_t k, const auto& visit) {
    for (size_t i = 0; i < front(k).below.size(); ++i) {
      const int p = front(k).below[i];
      visit(x.middleRows(first_[static_cast<size_t>(p)], size_at(p)), values_[k].L.middleRows(values_[k].row[i], size_at(p)));
    }
  };
  for (size_t k = 0; k < values_.size(); ++k) {
    auto mine = own(k);
    values_[k].L.topRows(front(k).own).triangularView<Eigen::Lower>().solveInPlace(mine);
    each_below(k, [&](auto theirs, const auto& L) { theirs.noalias() -= L * mine; });
  }
  for (size_t k = values_.size(); k-- > 0;) {
    auto mine = own(k);
    each_below(k, [&](const auto& theirs, const auto& L) { mine.noalias() -= L.transpose() * theirs; });
    values_[k].L.topRows(front(k).own).triangularView<Eigen::Lower>().transpose().solveInPlace(mine);
  }
  MatrixXd out(b.rows(), b.cols());
  for (size_t p = 0; p < place_.size(); ++p)
    out.middleRows(first_of_node_[p], size_at(static_cast<int>(p))) =
        s(p).asDiagonal() * x.middleRows(first_[p], size_at(static_cast<int>(p)));
  return out;
}

void NodeFactor::invert(Keep keep) {
  std::vector<MatrixXd> whole(values_.size());  // over a front's rows, for its children
  std::vector<std::atomic<int>> waiting(values_.size());
  for (const NodeFront& f : order_.fronts)
    if (f.parent >= 0) ++waiting[static_cast<size_t>(f.parent)];
  from_root([&](size_t k, bool alone) {
    const NodeFront& f = front(k);
    MatrixXd& L = values_[k].L;
    MatrixXd& Z = values_[k].Z;
    MatrixXd W(f.own + f.rows, f.own + f.rows);
    if (f.parent >= 0) {
      const auto parent = static_cast<size_t>(f.parent);
      const std::vector<int> from = rows_in_parent(k);
      W.bottomRightCorner(f.rows, f.rows) = whole[parent](from, from);
      if (--waiting[parent] == 0) whole[parent].resize(0, 0);
    }
    const auto L11 = L.topRows(f.own).triangularView<Eigen::Lower>();
    const MatrixXd inverse = L11.solve(MatrixXd::Identity(f.own, f.own));
    MatrixXd K = MatrixXd::Zero(f.rows, f.own);  // L21 by it
    by_columns(f.own, static_cast<double>(f.rows) * f.own * f.own, alone, [&](Index j, Index end) {
      auto to = K.middleCols(j, end - j);
      subtract_product(to, MatrixView::of(L.bottomRows(f.rows)), MatrixView::of(inverse.middleCols(j, end - j)));
      to = -to;
    });
    if (keep == Keep::inverse_alone) L.resize(0, 0);
    Z.setZero(f.own + f.rows, f.own);
    auto Z21 = Z.bottomRows(f.rows);
    by_columns(f.own, static_cast<double>(f.rows) * f.rows * f.own, alone, [&](Index j, Index end) {
      subtract_product(Z21.middleCols(j, end - j), MatrixView::of(W.bottomRightCorner(f.rows, f.rows)),
                       MatrixView::of(K.middleCols(j, end - j)));
    });
    by_columns(f.own, static_cast<double>(f.rows) * f.own * f.own, alone, [&](Index j, Index end) {
      auto to = Z.block(0, j, f.own, end - j);
      subtract_product(to, MatrixView::of(inverse).transposed(), MatrixView::of(inverse.middleCols(j, end - j)));
      to = -to;
      subtract_product(to, MatrixView::of(K).transposed(), MatrixView::of(Z21.middleCols(j, end - j)));
    });
    if (waiting[k] == 0) return;
    W.leftCols(f.own) = Z;
    W.topRightCorner(f.own, f.rows) = Z21.transpose();
    whole[k] = std::move(W);
  });
}

MatrixXd NodeFactor::block(int a, int b) const {
  if (a < b) return block(b, a).transpose();
  const auto k = static_cast<size_t>(front_at_[static_cast<size_t>(b)]);
  return values_[k].Z.block(row_in(k, a), row_in(k, b), size_at(a), size_at(b));
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

MatrixXd NodeFactor::covariance(int a, const std::vector<int>& rows, int b, const std::vector<int>& columns) const {
  const int pa = place_[static_cast<size_t>(a)], pb = place_[static_cast<size_t>(b)];
  if (pa < pb) return covariance(b, columns, a, rows).transpose();
  const auto k = static_cast<size_t>(front_at_[static_cast<size_t>(pb)]);
  const int row = row_in(k, pa), column = row_in(k, pb);
  const Eigen::Index of_a = first_of_node_[static_cast<size_t>(pa)], of_b = first_of_node_[static_cast<size_t>(pb)];
  MatrixXd out(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
  for (Index j = 0; j < out.cols(); ++j)
    for (Index i = 0; i < out.rows(); ++i) {
      const int r = rows[static_cast<size_t>(i)], c = columns[static_cast<size_t>(j)];
      out(i, j) = scale_[of_a + r] * values_[k].Z(row + r, column + c) * scale_[of_b + c];
    }
  return out;
}

}  // namespace swath::calib
