// SPDX-License-Identifier: GPL-3.0-or-later
// The process is a sum of waves with normal amplitudes (spectral representation, Shinozuka and Deodatis 1991); frequencies are the
// quantiles of the spectrum of a Gauss-Markov process, cut at 0.5 Hz, moved at random within their share. Its variance is exact, its
// autocorrelation near exp(-|t| / tau).
#include "simulate/errors.h"

#include <cmath>

#include "simulate/random.h"

namespace swath::simulate {

TrajectoryErrors::TrajectoryErrors(const NoiseOptions& noise, std::int64_t seed) {
  if (noise.noise_free) return;
  sigma_ = {noise.horizontal.value, noise.horizontal.value, noise.vertical.value,
            noise.roll_pitch.value, noise.roll_pitch.value, noise.heading.value};
  constexpr int n = 48;
  const double cut = std::atan(2 * core::pi * 0.5 * noise.correlation.value);
  for (size_t k = 0; k < 6; ++k) {
    Random random = random_of(seed, Stream::trajectory, k);
    for (int i = 0; i < n; ++i) {
      const double omega = std::tan((i + random.uniform()) / n * cut) / noise.correlation.value;
      const double share = sigma_[k] / std::sqrt(static_cast<double>(n));
      const double c = random.normal();
      waves_[k].push_back({omega, share * c, share * random.normal()});
    }
  }
}

TrajectoryErrors::At TrajectoryErrors::at(double t) const {
  At out;
  for (size_t k = 0; k < 6; ++k)
    for (const Wave& w : waves_[k]) {
      const double c = std::cos(w.omega * t), s = std::sin(w.omega * t);
      out.value[k] += w.cosine * c + w.sine * s;
      out.rate[k] += w.omega * (w.sine * c - w.cosine * s);
    }
  return out;
}

Motion delivered(const Motion& truth, const TrajectoryErrors::At& error) {
  Motion m = truth;
  core::Geodetic& p = m.pose.position;
  p.latitude += error.value[0] / (core::meridian_radius(p.latitude) + p.height);
  p.longitude += error.value[1] / ((core::prime_vertical_radius(p.latitude) + p.height) * std::cos(p.latitude));
  p.height += error.value[2];
  m.pose.attitude.roll += error.value[3];
  m.pose.attitude.pitch += error.value[4];
  m.pose.attitude.heading = core::wrap_two_pi(m.pose.attitude.heading + error.value[5]);
  m.velocity += Eigen::Vector3d(error.rate[0], error.rate[1], -error.rate[2]);
  return m;
}

core::Calibration true_calibration(const MountingOptions& mounting, std::int64_t seed) {
  core::Calibration c = mounting.truth;
  Random random = random_of(seed, Stream::mounting);
  for (core::Radians* angle : {&c.roll, &c.pitch, &c.heading}) angle->value += mounting.random_boresight.value * random.uniform(-1.0, 1.0);
  c.range_offset.value += mounting.random_range_offset.value * random.normal();
  c.scan_scale += mounting.random_scan_scale * random.normal();
  return c;
}

namespace {

/// The sigmas stated of a mounting that nobody calibrated: what is drawn has the sigma of its draw.
CalibrationSigma nominal_sigma_of(const MountingOptions& m) {
  CalibrationSigma s = m.nominal_sigma;
  if (m.random_boresight.value > 0.0) s.roll = s.pitch = s.heading = core::Radians(m.random_boresight.value / std::sqrt(3.0));
  if (m.random_range_offset.value > 0.0) s.range_offset = m.random_range_offset;
  if (m.random_scan_scale > 0.0) s.scan_scale = m.random_scan_scale;
  return s;
}

}  // namespace

DeliveredCalibration deliver_calibration(const MountingOptions& mounting, const NoiseOptions& noise, const ScannerOptions& scanner,
                                         std::int64_t seed) {
  const core::Calibration& t = mounting.truth;
  const CalibrationSigma& s = mounting.sigma;
  DeliveredCalibration out;
  out.calibration = t;
  core::Calibration& c = out.calibration;

  // Draws come in one order whatever is delivered, so that the same seed gives the same lever arm.
  Random random = random_of(seed, Stream::calibration);
  const double on = noise.noise_free ? 0.0 : 1.0;
  std::array<double, 3> lever{};
  for (double& v : lever) v = on * s.lever_arm.value * random.normal();
  const auto set_sigma = [&out](const CalibrationSigma& v) {
    out.sigma.roll = v.roll;
    out.sigma.pitch = v.pitch;
    out.sigma.heading = v.heading;
    out.sigma.lever_arm = v.lever_arm;
    out.sigma.range_offset = v.range_offset;
    out.sigma.range_scale = v.range_scale;
    out.sigma.scan_offset = v.scan_offset;
    out.sigma.scan_scale = v.scan_scale;
    out.sigma.latency = v.latency;
  };
  switch (mounting.deliver) {
    case Deliver::truth:
      set_sigma({});
      break;
    case Deliver::drawn:
      c.roll.value += on * s.roll.value * random.normal();
      c.pitch.value += on * s.pitch.value * random.normal();
      c.heading.value += on * s.heading.value * random.normal();
      c.range_offset.value += on * s.range_offset.value * random.normal();
      c.range_scale += on * s.range_scale * random.normal();
      c.scan_offset.value += on * s.scan_offset.value * random.normal();
      c.scan_scale += on * s.scan_scale * random.normal();
      c.latency.value += on * s.latency.value * random.normal();
      set_sigma(noise.noise_free ? CalibrationSigma{} : s);
      break;
    case Deliver::nominal:
      c = core::Calibration{};
      c.lever_arm_scanner = t.lever_arm_scanner;
      set_sigma(nominal_sigma_of(mounting));
      break;
  }
  if (mounting.deliver != Deliver::truth)
    for (size_t i = 0; i < 3; ++i) c.lever_arm_scanner[i].value += lever[i];

  const auto rounded = [](double sigma, double step) { return std::sqrt(sigma * sigma + step * step / 12.0); };
  out.sigma.range = core::Metres(on * rounded(noise.range.value, scanner.range_resolution.value));
  out.sigma.scan_angle = core::Radians(on * rounded(noise.scan_angle.value, scanner.angle_resolution.value));
  out.sigma.time = core::Seconds(0.0);
  out.sigma.beam_divergence = core::Radians(on * scanner.divergence.value);
  return out;
}

}  // namespace swath::simulate
