// SPDX-License-Identifier: GPL-3.0-or-later
// The order in which the nodes of a sparse symmetric matrix are eliminated, and which of them together.
//
// Sources: minimum degree (Eigen's AMD) on the graph of nodes; nodes whose rows below are nearly the same are one front (Duff and Reid
// 1983, relaxed amalgamation), so that most of the work is products of matrices instead of single columns.
#pragma once

#include <vector>

namespace swath::calib {

/// Consecutive places of the order that are eliminated together.
struct NodeFront {
  int first = 0, last = 0;  ///< places: [first, last)
  int parent = -1;          ///< front of the first place below; -1: none
  std::vector<int> below;   ///< places that the elimination touches, rising
  int own = 0, rows = 0;    ///< unknowns of its places, and of those below
  double work() const;      ///< multiplications of its elimination
};

struct NodeOrder {
  std::vector<int> node;          ///< by place
  std::vector<NodeFront> fronts;  ///< by place; a front and all that come before it in the tree lie side by side, it is their last
  /// Per front, the first of its subtree.
  std::vector<int> subtrees() const;
};

/// `neighbours`: of each node, both ways, rising; `sizes`: unknowns of each.
NodeOrder order_of(const std::vector<std::vector<int>>& neighbours, const std::vector<int>& sizes);

}  // namespace swath::calib
