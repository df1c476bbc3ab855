// SPDX-License-Identifier: GPL-3.0-or-later
// The normal equations of all groups put together: planes eliminated, priors added, solved, with covariances.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "calib/adjust/tie_matrix.h"
#include "calib/adjust/tie_normals.h"

namespace swath::calib {

/// One control observation, linearised: normal . (q - c) - d0 - d1 u - d2 v = 0 within sigma.
struct ControlRow {
  std::uint32_t plane = 0;
  double f = 0.0;                                ///< m, at d = 0
  Eigen::Vector3d by = Eigen::Vector3d::Zero();  ///< with respect to d0, d1, d2
  double sigma = 0.0;                            ///< m
};
/// All control of the planes, plane after plane.
std::vector<ControlRow> control_rows(const std::vector<TiePlane>& planes, double factor);

/// What takes part: by group, and by control observation.
struct TieSelection {
  std::vector<char> group, control;
};

/// What a plane leaves behind when it is eliminated.
struct PlaneRest {
  std::vector<int> index;                             ///< numbers of the unknowns that its groups touch, those left out too; rising
  Eigen::MatrixXd N_xp;                               ///< their normal equations with d0, d1, d2
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();  ///< of the plane's own 3 x 3
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
};

/// A group's block once the group's own departure from the plane (sigma `surface`) is eliminated; `surface` 0: there is none.
void with_surface(GroupBlock& block, double surface);

/// N x = -b, x = (global unknowns, corrections with their trends).
struct Normals {
  explicit Normals(const std::shared_ptr<const UnknownNodes>& nodes) : N(nodes), b(Eigen::VectorXd::Zero(nodes->unknowns())) {}
  /// Of a small system.
  explicit Normals(int unknowns) : N(TieMatrix::dense(unknowns)), b(Eigen::VectorXd::Zero(unknowns)) {}
  TieMatrix N;
  Eigen::VectorXd b;
};

class TieSystem {
 public:
  /// Blocks as linearised; `surface`: m.
  TieSystem(const TieProblem& problem, const std::vector<GroupBlock>& blocks, std::vector<ControlRow> control, double surface);

  /// Adds sign * (one plane's contribution) to the normal equations of size problem.size(). `white`: of the
  /// global unknowns alone, the corrections held and returns independent of one another.
  PlaneRest add(std::uint32_t plane, const TieSelection& use, double sign, Normals& into, bool white = false) const;
  /// All planes.
  Normals sum(const TieSelection& use, std::vector<PlaneRest>& rests) const;

  const GroupBlock& block(size_t group) const { return blocks_[group]; }  ///< with the surface's departure eliminated
  const GroupBlock& bare(size_t group) const { return (*bare_)[group]; }  ///< as linearised
  const std::vector<ControlRow>& control() const { return control_; }
  /// Numbers of the groups and control observations of a plane: [first, last).
  std::pair<size_t, size_t> groups_of(std::uint32_t plane) const { return {first_group_[plane], first_group_[plane + 1]}; }
  std::pair<size_t, size_t> control_of(std::uint32_t plane) const { return {first_control_[plane], first_control_[plane + 1]}; }
  size_t planes() const { return first_group_.size() - 1; }
  int globals() const { return static_cast<int>(problem_->globals.size()); }
  std::shared_ptr<const UnknownNodes> nodes() const { return nodes_; }
  double surface() const { return surface_; }

 private:
  const TieProblem* problem_;
  const std::vector<GroupBlock>* bare_;
  std::vector<GroupBlock> blocks_;
  std::vector<ControlRow> control_;
  std::vector<size_t> first_group_, first_control_;
  std::shared_ptr<const UnknownNodes> nodes_;
  double surface_;
};

/// What is known beforehand of the unknowns: sum of (x - x0)^T information (x - x0), x counted from the present state.
struct TiePrior {
  /// `corrections`: of the knots, with factors on their sigmas; `correction`: their present values, those of the trends after them.
  TiePrior(const TieProblem& problem, std::shared_ptr<const UnknownNodes> nodes, const ScaleFactors& position, const ScaleFactors& attitude,
           const Eigen::VectorXd& correction, Eigen::VectorXd globals, Eigen::VectorXd departure);
  /// (x - x0)^T information (x - x0) of the corrections as they are.
  double squares() const { return present.dot(corrections.times(present)); }

  TieMatrix corrections;      ///< information of the corrections, over all unknowns
  Eigen::VectorXd present;    ///< their present values, over all unknowns: x0 = -present
  Eigen::VectorXd globals;    ///< information of each global unknown; 0: free
  Eigen::VectorXd departure;  ///< of each global unknown's present value from its start
};
void add_prior(const TiePrior& prior, Normals& n);

/// The solution with its covariance.
struct TieSolution {
  Eigen::VectorXd x;                          ///< steps of the unknowns
  std::vector<Eigen::Vector3d> d;             ///< of each plane
  std::shared_ptr<const TieInverse> inverse;  ///< what was asked for
  bool solved = false;

  /// Covariance of some of x: each two of one plane, of one line's neighbouring knots, or of the globals with any.
  Eigen::MatrixXd covariance(const std::vector<int>& unknowns) const { return inverse->of(unknowns); }
  Eigen::MatrixXd of_globals(int globals) const;
};
/// What is kept of the inverse: the factor for solve(), the covariances, or both.
enum class Inverse { factor, covariance, both };
TieSolution solve(const TieSystem& system, const Normals& with_prior, const std::vector<PlaneRest>& rests, Inverse keep);
/// Covariance of a plane's d0, d1, d2; `of_rest`: of the unknowns of rest.index.
Eigen::Matrix3d plane_covariance(const PlaneRest& rest, const Eigen::MatrixXd& of_rest);

/// A linear function h . (x, d) of the unknowns and one plane's three, with the plane eliminated. h: over the unknowns `of`, which are
/// among the plane's, then the three.
struct PlaneRow {
  PlaneRow(const Eigen::VectorXd& h, const std::vector<int>& of, const PlaneRest& rest);
  /// `of_rest`: covariance of the unknowns of rest.index.
  double variance(const Eigen::MatrixXd& of_rest) const { return own_variance + value.dot(of_rest * value); }

  Eigen::VectorXd value;  ///< by the unknowns of rest.index
  double own_variance = 0.0;
};

}  // namespace swath::calib
