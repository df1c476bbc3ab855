// SPDX-License-Identifier: GPL-3.0-or-later
// What planes that several flight lines have seen say of a flight's states and of the scanner's calibration.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "calib/adjust/adjust_options.h"
#include "calib/adjust/tie_normals.h"
#include "calib/adjust/variance_components.h"
#include "calib/network/flight_states.h"
#include "calib/ties/tie_set.h"
#include "core/records/sensor.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

/// How one line's returns lie about one plane.
struct PlaneMisfit {
  std::uint32_t plane = 0, line = 0;
  double mean = 0.0;   ///< of its returns from the plane, m
  double sigma = 0.0;  ///< of that mean by noise and surface alone, m
  double weight = 1.0;
  std::uint32_t returns = 0, rejected = 0;      ///< with a weight; far from their group
  double time = 0.0, angle = 0.0, range = 0.0;  ///< means, calibrated: s, rad, m
  double rms = 0.0;                             ///< of the returns from the plane, m
};

class PlaneFactors {
 public:
  /// What a plane leaves behind when it is eliminated: its step is -inverse (b + N_xp^T x).
  struct Rest {
    std::vector<int> index;  ///< unknowns that its groups touch, rising; see place_of()
    Eigen::MatrixXd N_xp;
    Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
  };
  struct Place {  ///< of an unknown: node and row in it
    int node;
    Eigen::Index row;
  };

  /// All must outlive it. `times`: of the instants; `unknown`: calibration values that are estimated, rising; `surface`: sigma by which a
  /// plane seen in one line departs from that of all, m; `wander`: power spectral density of the gyros' white noise, rad^2/s: between two
  /// instants the attitude departs from the straight line by a Brownian bridge, which the states do not hold.
  PlaneFactors(const TieSet& ties, const core::Scanner& scanner, const core::SensorSigma& sensor, std::vector<double> times,
               std::vector<Parameter> unknown, const RobustOptions& robust, double surface, double wander, int threads);

  /// Fits the planes to the returns as they lie, without groups that have lost their weight, and takes from their roughness what is not
  /// noise. Before the first linearisation.
  void fit(const trajectory::Trajectory& trajectory, const core::Calibration& calibration);
  /// Which intervals between instants a trajectory needs for linearise(): those of the returns, `margin` (s) before and after them
  /// included.
  std::vector<char> intervals(const core::Calibration& calibration, double margin) const;
  /// All returns at a trajectory, which passes through the states, and a calibration.
  void linearise(const trajectory::Trajectory& trajectory, const core::Calibration& calibration);
  /// Adds all planes with their own unknowns eliminated.
  void add(const FlightStates& states, NetworkNormals& into);
  /// Moves the planes as a solution asks for.
  void follow(const Eigen::VectorXd& x, const FlightStates& states);
  /// Weighs groups by their misfits: those far beyond what noise, surface and the others' scatter explain lose their weight.
  void weigh();

  /// Leaves a group out for good.
  void reject(size_t group) { rejected_[group] = 1, weight_[group] = 0.0; }
  double surface() const { return surface_; }
  void set_surface(double sigma) { surface_ = sigma; }

  const std::vector<TiePlane>& planes() const { return state_.planes; }
  std::vector<PlaneMisfit> misfits() const;
  size_t groups() const { return blocks_.size(); }
  /// Numbers of a plane's groups: [first, last).
  std::pair<size_t, size_t> groups_of(std::uint32_t plane) const { return {first_group_[plane], first_group_[plane + 1]}; }
  const GroupBlock& block(size_t group) const { return blocks_[group]; }  ///< as linearised, of single returns alone
  /// As the solution has it: a trace for one that is far off, so that it can be tested; 0 for one that was rejected.
  double weight(size_t group) const { return rejected_[group] ? 0.0 : std::max(weight_[group], trace_weight); }
  bool left_out(size_t group) const { return weight_[group] <= 0.0; }
  bool is_rejected(size_t group) const { return rejected_[group] != 0; }
  /// Of a group's mean beyond the noise of its returns: surface, and attitude between the instants, m^2.
  double variance_between(size_t group) const;
  const Rest& rest(std::uint32_t plane) const { return rests_[plane]; }  ///< of the last add()
  Place place_of(int unknown, const FlightStates& states) const;
  double consistency() const { return robust_.consistency(); }
  double noise_factor() const { return scale_; }  ///< robust sigma of single returns about their group, in the sigmas that were used
  const SigmaFactor& range_factor() const { return factors_.range; }  ///< on the stated sigmas, from returns about their groups
  const SigmaFactor& angle_factor() const { return factors_.angle; }  ///< of scan angle and pointing
  std::uint64_t left_out() const;                                     ///< groups without weight, rejected ones among them
  std::uint64_t rejected() const;

 private:
  static constexpr double trace_weight = 1e-6;
  struct Worker;
  // Unknowns that planes touch: six of each instant (position, attitude), then the calibration's.
  int number_of(int instant, int component) const { return 6 * instant + component; }
  int calibration_number() const { return 6 * static_cast<int>(times_.size()); }
  int interval_at(double t) const;
  void linearise_group(Worker& worker, size_t number);
  void fill_block(Worker& worker, size_t number, double median);
  void fit_plane(std::uint32_t plane);
  void set_roughness();
  void set_noise();
  /// A plane's part of the normal equations without its own unknowns.
  struct Reduced {
    Rest rest;
    Eigen::MatrixXd N;
    Eigen::VectorXd b;
    double squares = 0.0;
  };
  Reduced reduced(std::uint32_t plane) const;
  void scatter(const Rest& rest, const Eigen::MatrixXd& N, const Eigen::VectorXd& b, const FlightStates& states,
               NetworkNormals& into) const;

  const TieSet* ties_;
  const core::Scanner* scanner_;
  TieNoise stated_, noise_;
  SigmaFactors factors_;
  std::vector<double> times_;
  std::vector<Parameter> unknown_;
  RobustWeight robust_;
  double surface_, wander_;
  int threads_;
  CorrectionKnots no_knots_;
  TieProblem problem_;
  TieState state_;
  std::vector<GroupBlock> blocks_;
  std::vector<double>
      turn_;  // of each group: variance of its mean by the body's wander between instants, per unit of spectral density, m^2 s/rad^2
  std::vector<double> weight_;  // of each group
  std::vector<char> rejected_;
  std::vector<float> deviation_;
  std::vector<size_t> first_group_;
  std::vector<Rest> rests_;
  double scale_ = 1.0;
};

}  // namespace swath::calib
