// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Jubanski and Mitishita 2005, eqs 1-20. Axis by axis is the simultaneous form with the covariances between axes left out: the
// six states then fall into three pairs. Deviations:
// - 1 % is a standard deviation (the paper calls it a variance); by default of the speed vector's length, with a floor: an axis with little
//   speed of its own would have next to no noise and lag behind (height: 0.25-0.35 m instead of 0.05 m, docs/kinematic.md).
// - By default the noise's variance grows with the step: the step to the event is a fraction of the others. This moves an event by up to
//   2 cm.
// - Diffuse start values do not see the window's fixes twice.
// - The update is in Joseph's form, which keeps its digits where the state is diffuse; the same numbers otherwise.
#include "trajectory/kinematic.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "core/statistics.h"

namespace swath::trajectory {

namespace {

using Matrix6 = PointState::Matrix6;
using Matrix63 = Eigen::Matrix<double, 6, 3>;

constexpr double diffuse_variance = 1e6;  // m^2 and (m/s)^2: a kilometre, far beyond any error of the line

Eigen::Matrix3d fix_covariance(const PointFixes& fixes, size_t i, const KinematicOptions& o) {
  if (o.axes == AxesForm::axis) return fixes.covariance[i].diagonal().asDiagonal();
  return fixes.covariance[i];
}

PolynomialFit window_polynomial(const PointFixes& fixes, const FixWindow& w, int degree, const KinematicOptions& o) {
  return fit_polynomial(fixes, w, degree, o.axes == AxesForm::axis, o.line_weights == LineWeights::weighted);
}

// Eq 7 and its wider forms.
Eigen::Vector3d velocity_noise(const Eigen::Vector3d& v, const KinematicOptions& o) {
  const Eigen::Vector3d speed = o.noise == NoiseSpeed::axis ? Eigen::Vector3d(v.cwiseAbs()) : Eigen::Vector3d::Constant(v.norm());
  return (o.noise_share * speed).cwiseMax(o.noise_floor.value);
}

PointState start_values(const PolynomialFit& line, double t, const KinematicOptions& o) {
  PointState s;
  s.time = t;
  s.x << line.position(t), line.velocity(t);
  if (o.start_covariance == StartCovariance::diffuse) {
    s.covariance.diagonal().setConstant(diffuse_variance);
    return s;
  }
  s.covariance = line.covariance_at(t);
  if (o.start_covariance == StartCovariance::a_posteriori) {
    PointState::Vector6 scale;
    scale << line.variance_factor.cwiseSqrt(), line.variance_factor.cwiseSqrt();
    s.covariance = scale.asDiagonal() * s.covariance * scale.asDiagonal();
  }
  return s;
}

// The filter over fixes i = first, first + step ... (n of them) and on to the event.
PointState run(const PointFixes& fixes, PointState state, size_t first, int step, size_t n, double event, const Eigen::Vector3d& noise,
               const KinematicOptions& o, std::vector<KinematicTrace::Step>* trace) {
  const auto noise_of = [&](double dt) {
    Matrix6 q = Matrix6::Zero();
    q.diagonal().tail<3>() = noise.cwiseAbs2() * (o.noise_grows_with_time ? std::abs(dt) : 1.0);
    return q;
  };
  for (size_t k = 0; k < n; ++k) {
    const size_t i = step > 0 ? first + k : first - k;
    if (k > 0) {
      const double dt = fixes.time[i] - state.time;
      state = predict(state, dt, noise_of(dt));
      state.time = fixes.time[i];
      if (trace) trace->push_back({KinematicTrace::Kind::predict, state});
    }
    if (k == 0 && !o.update_first) continue;
    Matrix63 gain;
    state = update(state, fixes.position[i], fix_covariance(fixes, i, o), &gain);
    if (trace) trace->push_back({KinematicTrace::Kind::update, state, gain});
  }
  const double dt = event - state.time;
  state = predict(state, dt, noise_of(dt));
  state.time = event;
  if (trace) trace->push_back({KinematicTrace::Kind::predict_to_event, state});
  return state;
}

}  // namespace

double longest_step(const PointFixes& fixes, const KinematicOptions& o) { return o.gap_steps * core::median_step(fixes.time); }

PointState predict(const PointState& s, double dt, const Matrix6& noise) {
  PointState out;
  out.time = s.time + dt;
  out.x << s.position() + dt * s.velocity(), s.velocity();  // eq 2-3
  Matrix6 transition = Matrix6::Identity();
  transition.topRightCorner<3, 3>().diagonal().setConstant(dt);
  out.covariance = transition * s.covariance * transition.transpose() + noise;  // eq 4-6
  return out;
}

PointState update(const PointState& s, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance, Matrix63* gain) {
  const Eigen::Matrix3d innovation = s.covariance.topLeftCorner<3, 3>() + covariance;
  const Matrix63 k = innovation.llt().solve(s.covariance.topRows<3>()).transpose();  // eq 8-10
  PointState out = s;
  out.x += k * (position - s.position());  // eq 11-12
  Matrix6 rest = Matrix6::Identity();
  rest.leftCols<3>() -= k;
  out.covariance = rest * s.covariance * rest.transpose() + k * covariance * k.transpose();  // eq 13
  if (gain) *gain = k;
  return out;
}

PointState fuse(const PointState& a, const PointState& b) {
  // Eq 14-15, (Pa^-1 + Pb^-1)^-1 = Pa - Pa (Pa + Pb)^-1 Pa: one solution in place of three inverses.
  const Matrix6 sum = a.covariance + b.covariance;
  const Matrix6 share = sum.llt().solve(a.covariance).transpose();
  PointState out = a;
  out.x += share * (b.x - a.x);
  out.covariance = a.covariance - share * a.covariance;
  out.covariance = 0.5 * (out.covariance + out.covariance.transpose()).eval();
  return out;
}

PointState interpolate(const PointFixes& fixes, const FixWindow& w, double t, const KinematicOptions& o, KinematicTrace* trace) {
  const PolynomialFit line = window_polynomial(fixes, w, 1, o);
  const Eigen::Vector3d noise = velocity_noise(line.coefficients.col(1), o);
  const PointState start_forward = start_values(line, fixes.time[w.before], o);
  const PointState start_backward = start_values(line, fixes.time[w.last()], o);
  if (trace) *trace = {noise, start_forward, start_backward, {}, {}};
  const PointState forward = run(fixes, start_forward, w.before, 1, w.middle - w.before, t, noise, o, trace ? &trace->forward : nullptr);
  const PointState backward = run(fixes, start_backward, w.last(), -1, w.end - w.after, t, noise, o, trace ? &trace->backward : nullptr);
  return fuse(forward, backward);
}

PointState polynomial_at(const PointFixes& fixes, const FixWindow& w, double t, int degree, const KinematicOptions& o) {
  const PolynomialFit fit = window_polynomial(fixes, w, degree, o);
  PointState s;
  s.time = t;
  s.x << fit.position(t), fit.velocity(t);
  s.covariance = fit.covariance_at(t);
  return s;
}

}  // namespace swath::trajectory
