// SPDX-License-Identifier: GPL-3.0-or-later
// The symmetric matrix of an adjustment's unknowns and its inverse. A small adjustment is one node, its matrix dense; one of many knots has
// a node for each, and only blocks of those that share an observation (calib/sparse/node_matrix.h).
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "calib/sparse/node_matrix.h"

namespace swath::calib {

/// Which node each unknown belongs to. Unknowns of one node are in the order of their numbers.
class UnknownNodes {
 public:
  /// `node`: of each unknown; nodes are numbered from 0 without gaps.
  explicit UnknownNodes(std::vector<int> node);

  int unknowns() const { return static_cast<int>(node_.size()); }
  const std::vector<int>& sizes() const { return sizes_; }
  int node(int unknown) const { return node_[static_cast<size_t>(unknown)]; }
  int row(int unknown) const { return row_[static_cast<size_t>(unknown)]; }

  /// Some unknowns by their nodes: rows in the node, and places in the list that was given.
  struct Part {
    int node = 0;
    std::vector<int> rows, places;
  };
  std::vector<Part> parts(const std::vector<int>& unknowns) const;

 private:
  std::vector<int> node_, row_, sizes_;
};

class TieMatrix {
 public:
  explicit TieMatrix(std::shared_ptr<const UnknownNodes> nodes) : nodes_(std::move(nodes)), N_(nodes_->sizes()) {}
  /// Of one node.
  static TieMatrix dense(int unknowns);

  /// Adds factor * M, symmetric, to the rows and columns of some unknowns.
  void add(const std::vector<int>& unknowns, const Eigen::MatrixXd& M, double factor = 1.0);
  void add(const TieMatrix& other);
  Eigen::VectorXd times(const Eigen::VectorXd& x) const;
  Eigen::VectorXd diagonal() const;
  /// All of it, zeros included: of small ones.
  Eigen::MatrixXd whole() const;
  int unknowns() const { return nodes_->unknowns(); }

 private:
  friend class TieInverse;
  std::shared_ptr<const UnknownNodes> nodes_;
  NodeMatrix N_;
};

/// Factorised, and inverted where two unknowns share a node or an observation.
class TieInverse {
 public:
  explicit TieInverse(const TieMatrix& matrix) : nodes_(matrix.nodes_), first_(firsts(matrix)), factor_(matrix.N_) {}

  /// Of the matrix scaled to ones on its diagonal: a combination of unknowns that is not determined to 1e-13 of that is held so far.
  double smallest_pivot() const { return factor_.smallest_pivot(); }
  /// Columns side by side, rows by unknown.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;
  /// Before of() and diagonal(); once. `inverse_alone`: half the memory, and solve() cannot be called any more.
  void invert(NodeFactor::Keep keep = NodeFactor::Keep::factor) { factor_.invert(keep); }
  /// Of some unknowns, in their order.
  Eigen::MatrixXd of(const std::vector<int>& unknowns) const;
  Eigen::VectorXd diagonal() const;

 private:
  static std::vector<int> firsts(const TieMatrix& matrix);
  int place(int unknown) const { return first_[static_cast<size_t>(nodes_->node(unknown))] + nodes_->row(unknown); }

  std::shared_ptr<const UnknownNodes> nodes_;
  std::vector<int> first_;  // of each node's unknowns in the factor's vectors
  NodeFactor factor_;
};

}  // namespace swath::calib
