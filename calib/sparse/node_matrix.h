// SPDX-License-Identifier: GPL-3.0-or-later
// A sparse symmetric matrix by blocks: each node (an image, a camera, a set of drifts) has a few unknowns. Factorised by fronts, and
// inverted on the pattern of its factor, which holds every block between nodes that share an observation or an eliminated point.
//
// Sources: multifrontal elimination (Duff and Reid 1983), the sparse part of the inverse (Takahashi et al. 1973), the order and the fronts
// of calib/sparse/node_order.h. Unknowns are scaled to a unit diagonal first: a pivot is then the share of an unknown's information that is
// left when those before it are unknown, too. Subtrees and large fronts are worked on by all threads of the run; the result is the same for
// any number of them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "calib/sparse/node_order.h"

namespace swath::calib {

class NodeMatrix {
 public:
  /// Number of unknowns of each node.
  explicit NodeMatrix(std::vector<int> sizes);

  int nodes() const { return static_cast<int>(sizes_.size()); }
  int size(int node) const { return sizes_[static_cast<size_t>(node)]; }
  int first(int node) const { return first_[static_cast<size_t>(node)]; }
  int unknowns() const { return first_.back(); }
  /// Adds M (size(a) x size(b)) to the block of rows a and columns b, and its transpose to the block of rows b and columns a.
  void add(int a, int b, const Eigen::Ref<const Eigen::MatrixXd>& M);
  /// The block of rows a >= columns b to add to, zero at first; until the next call of this or add().
  Eigen::Map<Eigen::MatrixXd> block_for(int a, int b);
  /// The block of rows a >= columns b as stored; empty where nothing was added.
  Eigen::Map<const Eigen::MatrixXd> block(int a, int b) const;
  /// Rows and columns of the blocks, rising.
  std::vector<std::pair<int, int>> blocks() const;
  /// Per node, the other nodes that it has a block with.
  std::vector<std::vector<int>> neighbours() const;
  Eigen::VectorXd diagonal() const;

 private:
  static std::uint64_t key(int a, int b) { return static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b); }
  std::vector<int> sizes_, first_;
  std::unordered_map<std::uint64_t, size_t> at_;  // rows a >= columns b: where in values_
  std::vector<double> values_;
};

class NodeFactor {
 public:
  /// `shift` is added to the diagonal once that is scaled to 1. A pivot below 1e-13 is replaced by 1e-13: see smallest_pivot().
  explicit NodeFactor(const NodeMatrix& matrix, double shift = 0.0);

  /// Of the scaled matrix: near 0 where a combination of unknowns is not determined. 1e-13 is the least that is returned.
  double smallest_pivot() const { return smallest_pivot_; }
  /// Solution of matrix x = b, columns side by side.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;
  /// By which unknowns are multiplied to scale them: 1 / sqrt(diagonal); 1 where that is 0.
  const Eigen::VectorXd& scale() const { return scale_; }

  enum class Keep { factor, inverse_alone };
  /// Computes the inverse on the factor's pattern; once, before covariance(). `inverse_alone`: the factor, which is as large, goes as the
  /// inverse comes, and solve() cannot be called any more.
  void invert(Keep keep = Keep::factor);
  /// The inverse's rows and columns of some nodes, in their order. Each two of them must have had a block, or a common front.
  Eigen::MatrixXd covariance(const std::vector<int>& nodes) const;
  /// Some rows of node `a` and some columns of node `b` of the inverse.
  Eigen::MatrixXd covariance(int a, const std::vector<int>& rows, int b, const std::vector<int>& columns) const;

 private:
  using Neighbours = std::vector<std::vector<int>>;
  struct Values {
    std::vector<int> row;  // first of each place below, counted from the front's own first
    Eigen::MatrixXd L;     // columns of its own unknowns: their rows, then those below
    Eigen::MatrixXd Z;     // of the inverse
  };
  const NodeFront& front(size_t k) const { return order_.fronts[k]; }
  int size_at(int place) const { return first_[static_cast<size_t>(place) + 1] - first_[static_cast<size_t>(place)]; }
  int row_in(size_t front, int place) const;
  /// Rows of a front's places below in its parent.
  std::vector<int> rows_in_parent(size_t front) const;
  /// Calls work(front, alone) for all: subtrees side by side, then what is left of the tree one after another; or the other way round.
  void from_leaves(const std::function<void(size_t, bool)>& work) const;
  void from_root(const std::function<void(size_t, bool)>& work) const;
  void factorise(const NodeMatrix& matrix, const Neighbours& neighbours, double shift);
  void place_columns(const NodeMatrix& matrix, const Neighbours& neighbours, size_t front, Eigen::MatrixXd& L) const;
  void divide_tree();
  Eigen::MatrixXd block(int a, int b) const;  // of the inverse, scaled; places

  NodeOrder order_;
  std::vector<Values> values_;  // by front
  std::vector<int> place_, front_at_, first_, first_of_node_;
  std::vector<std::pair<size_t, size_t>> subtrees_;  // fronts of those that are worked on side by side: [first, last)
  std::vector<size_t> trunk_;                        // the others, rising
  Eigen::VectorXd scale_;
  double smallest_pivot_ = 1.0;
};

}  // namespace swath::calib
