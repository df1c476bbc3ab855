// SPDX-License-Identifier: GPL-3.0-or-later
// A sparse symmetric matrix by blocks: each node (an image, a camera, a set of drifts) has a few unknowns. Factorised by fronts, and
// inverted on the pattern of its factor, which holds every block between nodes that share an observation or an eliminated point.
//
// Sources: multifrontal elimination (Duff and Reid 1983), the sparse part of the inverse (Takahashi et al. 1973), ordering by minimum
// degree (Eigen's AMD) on the graph of nodes. Unknowns are scaled to a unit diagonal first: a pivot is then the share of an unknown's
// information that is left when those before it are unknown, too.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

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
  /// The block of rows a >= columns b as stored; empty where nothing was added.
  Eigen::Map<const Eigen::MatrixXd> block(int a, int b) const;
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

 private:
  struct Front {
    int node = 0, parent = -1;  // parent: a place in the order
    std::vector<int> below;     // places in the order, rising
    int rows = 0;               // of below
    Eigen::MatrixXd L11, L21;   // of the node's own rows, and of those below
    Eigen::MatrixXd Z11, Z21;   // of the inverse
  };
  void order(const NodeMatrix& matrix);
  void factorise(const NodeMatrix& matrix, double shift);
  int size_at(int place) const { return sizes_[static_cast<size_t>(place)]; }
  Eigen::MatrixXd block(int a, int b) const;  // of the inverse, scaled; places
  int row_in(const Front& front, int place) const;

  std::vector<Front> fronts_;  // by place in the order
  std::vector<int> place_, sizes_, first_, first_of_node_;
  Eigen::VectorXd scale_;
  double smallest_pivot_ = 1.0;
};

}  // namespace swath::calib
