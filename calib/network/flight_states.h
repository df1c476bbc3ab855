// SPDX-License-Identifier: GPL-3.0-or-later
// The unknowns of a whole flight: which errors of the smoother's state each instant has, and which are the same for all.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "calib/sparse/node_matrix.h"
#include "trajectory/ins/ins_problem.h"

namespace swath::calib {

/// Nodes of a NodeMatrix: two per instant with the errors that change, `pose` (position, attitude: what surfaces see) and `motion`
/// (velocity, biases, the fixes' correlated part), and a last one, `common`, with those that do not (scales, lever arm, latency, a
/// vehicle's axis), followed by the scanner's calibration. Lines share planes by their poses alone: with one node per instant each such
/// pair would take six to nine times the memory, and the factor nearly twice the work.
class FlightStates {
 public:
  /// `calibration`: number of the calibration's unknowns.
  FlightStates(const trajectory::Layout& layout, size_t instants, int calibration = 0);

  std::vector<int> sizes() const;
  int size(int node) const {
    return node == common() ? calibration_first() + calibration_ : node % 2 == 0 ? pose_size : static_cast<int>(moving_.size()) - pose_size;
  }
  static constexpr int pose_size = 6;
  static int pose(int instant) { return 2 * instant; }
  static int motion(int instant) { return 2 * instant + 1; }
  int common() const { return 2 * instants_; }
  int instants() const { return instants_; }
  /// Rows of the layout that each instant has: those of its pose, then of its motion.
  const std::vector<int>& moving() const { return moving_; }
  /// Rows of the layout in the common node; the calibration follows them.
  const std::vector<int>& constant() const { return constant_; }
  int calibration_first() const { return static_cast<int>(constant_.size()); }
  int calibration_size() const { return calibration_; }
  /// Number of a node's first unknown; those of an instant follow one another.
  Eigen::Index first(int node) const { return static_cast<Eigen::Index>(moving_.size()) * (node / 2) + (node % 2) * pose_size; }
  /// The error of one instant in the layout's order.
  trajectory::StateVector at(int instant, const Eigen::VectorXd& x) const;

 private:
  int instants_, calibration_;
  std::vector<int> moving_, constant_;
};

/// N x = b.
struct NetworkNormals {
  explicit NetworkNormals(const std::vector<int>& sizes) : N(sizes), b(Eigen::VectorXd::Zero(N.unknowns())) {}

  /// The part of an observation's derivatives that belongs to one node.
  using Part = std::pair<int, Eigen::MatrixXd>;
  /// Adds the sum of squares (f - A x)^T W (f - A x), A by parts.
  void add(const std::vector<Part>& parts, const Eigen::MatrixXd& W, const Eigen::VectorXd& f);

  NodeMatrix N;
  Eigen::VectorXd b;
  double squares = 0.0;  ///< of the observations at x = 0, weighted
};

/// The inverse of a covariance whose rows may be of very different sizes; a variance below `floor` of its row counts as that.
Eigen::MatrixXd information_of(Eigen::MatrixXd covariance, const Eigen::VectorXd& floor);

}  // namespace swath::calib
