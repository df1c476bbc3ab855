// SPDX-License-Identifier: GPL-3.0-or-later
// Position of a GNSS antenna at an event between two fixes: a Kalman filter forward to it and one backward to it, fused.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/config/option.h"
#include "trajectory/fix_window.h"

namespace swath::trajectory {

enum class AxesForm { axis, simultaneous };
enum class LineWeights { weighted, ordinary };
enum class StartCovariance { a_priori, a_posteriori, diffuse };
enum class NoiseSpeed { axis, speed };

struct KinematicOptions {
  int epochs = 5;
  double gap_steps = 2.5;
  AxesForm axes = AxesForm::simultaneous;
  LineWeights line_weights = LineWeights::weighted;
  StartCovariance start_covariance = StartCovariance::diffuse;
  bool update_first = true;
  NoiseSpeed noise = NoiseSpeed::speed;
  double noise_share = 0.01;
  core::MetresPerSecond noise_floor{0.05};
  bool noise_grows_with_time = true;
  core::RadiansPerSecond turn_rate{0.0087};
};

template <class V>
void describe(KinematicOptions& o, V& v) {
  v.option("epochs", o.epochs, core::within(2, 1000), "Fixes of the window before the event, and as many after it.", "Jubanski2005");
  v.option("gap_steps", o.gap_steps, core::within(2.1, 1000),
           "A step between fixes of more than this many median steps is a gap, at which windows end.");
  v.option("axes", o.axes, "Each axis for itself, or the three at once with the full covariance of each fix.", "Jubanski2005 eq 2-20");
  v.option("line_weights", o.line_weights, "Start values: straight line with weights of the fixes' variances, or with unit weights.",
           "Jubanski2005 eq 1");
  v.option("start_covariance", o.start_covariance,
           "Covariance of the start values: of the line before or after its residuals, or very large.");
  v.option("update_first", o.update_first, "The window's first fix updates the start values too.");
  v.option("noise", o.noise, "Speed whose share is the noise: each axis's own (literal), or the length of the vector.",
           "Jubanski2005 eq 7");
  v.option("noise_share", o.noise_share, core::above_to(0.0, 1.0), "Standard deviation of the velocity's noise as a share of that speed.",
           "Jubanski2005 eq 7");
  v.option("noise_floor", o.noise_floor, core::at_least(0.0), "Least standard deviation of the velocity's noise.");
  v.option("noise_grows_with_time", o.noise_grows_with_time,
           "The noise is that of one second and its variance grows with the step; false: that of any step.");
  v.option("turn_rate", o.turn_rate, core::above(0.0), "Course that changes faster is a turn, where the survey states no [[line]].");
}

/// Position and velocity of a point with their covariance; order: three of position (m), three of velocity (m/s).
struct PointState {
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  double time = 0.0;  ///< s
  Vector6 x = Vector6::Zero();
  Matrix6 covariance = Matrix6::Zero();

  Eigen::Vector3d position() const { return x.head<3>(); }
  Eigen::Vector3d velocity() const { return x.tail<3>(); }
};

/// Everything the filter did for one event.
struct KinematicTrace {
  enum class Kind { update, predict, predict_to_event };
  struct Step {
    Kind kind;
    PointState state;
    Eigen::Matrix<double, 6, 3> gain = Eigen::Matrix<double, 6, 3>::Zero();  ///< of updates
  };
  Eigen::Vector3d noise;  ///< standard deviation of the velocity's noise, m/s
  PointState start_forward, start_backward;
  std::vector<Step> forward, backward;
};

/// Longest step between fixes that is no gap, s.
double longest_step(const PointFixes& fixes, const KinematicOptions& options);

/// The state at t, which lies within the window, from its fixes. The window must be reached().
PointState interpolate(const PointFixes& fixes, const FixWindow& window, double t, const KinematicOptions& options,
                       KinematicTrace* trace = nullptr);

/// For comparison: the weighted polynomial through the window at t.
PointState polynomial_at(const PointFixes& fixes, const FixWindow& window, double t, int degree, const KinematicOptions& options);

/// One prediction of the constant-velocity model over dt (either sign) with noise added.
PointState predict(const PointState& state, double dt, const PointState::Matrix6& noise);
/// One update by an observed position; the covariance in Joseph's form. `gain` where wanted.
PointState update(const PointState& state, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance,
                  Eigen::Matrix<double, 6, 3>* gain = nullptr);
/// Two independent estimates of one state, weighted by their information.
PointState fuse(const PointState& a, const PointState& b);

}  // namespace swath::trajectory

namespace swath::core {
template <>
struct Choices<trajectory::AxesForm> {
  static constexpr std::array<std::string_view, 2> names{"axis", "simultaneous"};
};
template <>
struct Choices<trajectory::LineWeights> {
  static constexpr std::array<std::string_view, 2> names{"weighted", "ordinary"};
};
template <>
struct Choices<trajectory::StartCovariance> {
  static constexpr std::array<std::string_view, 3> names{"a_priori", "a_posteriori", "diffuse"};
};
template <>
struct Choices<trajectory::NoiseSpeed> {
  static constexpr std::array<std::string_view, 2> names{"axis", "speed"};
};
}  // namespace swath::core
