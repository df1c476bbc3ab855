// SPDX-License-Identifier: GPL-3.0-or-later
// Warnings are tests of hypotheses: with a right model each false alarm has a probability below 1e-3.
#include "trajectory/ins/ins_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "core/statistics.h"
#include "trajectory/ins/ins_noise.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double arcsec = core::degree / 3600, deg_per_hour = core::degree / 3600, micro_g = 9.80665e-6;
constexpr double nis_tolerance = 0.3;   // the mean NIS per degree of freedom may leave 1 by this before it is reported
constexpr double sure_sigmas = 4.0;     // of a constant against its stated sigma
constexpr double observed_share = 0.5;  // a constant counts as observed when its sigma has fallen below this share
constexpr double outlier_share = 0.02;
constexpr double too_cautious = 1.5;  // times that stated sigmas of fixes are too large
constexpr double long_outage = 10.0;  // s

std::string text(const char* form, double a, double b = 0, double c = 0, double d = 0) {
  std::array<char, 320> out{};
  std::snprintf(out.data(), out.size(), form, a, b, c, d);
  return out.data();
}

using Warnings = std::vector<std::string>;

InsEstimates sensor_constants(const InsFindings& f) {
  const SmoothedNode& node = f.run.nodes[f.run.nodes.size() / 2];
  const Estimate& e = node.estimate;
  const Layout& l = f.problem.layout;
  const auto sigma = [&node](int row) -> Vector3d { return row < 0 ? Vector3d::Zero() : Vector3d(node.sigma.segment<3>(row)); };
  InsEstimates out;
  out.gyro_bias = {"gyro_bias", "deg_per_h",        deg_per_hour,
                   e.gyro_bias, sigma(l.gyro_bias), std::hypot(f.spec.gyro_bias.value, f.spec.gyro_drift.value)};
  out.accelerometer_bias = {"accelerometer_bias",
                            "ug",
                            micro_g,
                            e.force_bias,
                            sigma(l.force_bias),
                            std::hypot(f.spec.accelerometer_bias.value, f.spec.accelerometer_drift.value)};
  if (l.gyro_scale >= 0) out.gyro_scale = {"gyro_scale", "ppm", 1e-6, e.gyro_scale, sigma(l.gyro_scale), f.spec.gyro_scale.value};
  if (l.force_scale >= 0)
    out.accelerometer_scale = {"accelerometer_scale", "ppm", 1e-6, e.force_scale, sigma(l.force_scale), f.spec.accelerometer_scale.value};
  return out;
}

/// What the clocks show. With gnss_latency the filter has allowed for a small offset.
void judge_clocks(const InsFindings& f, InsFigures& out, Warnings& warnings) {
  const InsGnssOptions& o = f.problem.options;
  if (f.clocks.apart() && !(o.gnss_latency && std::abs(f.clocks.imu.value) < sure_sigmas * o.latency_sigma.value))
    out.named.push_back({"trajectory.clocks", f.clocks.advice()});
  if (f.clocks.velocities_lag())
    warnings.push_back(text("the GNSS velocities are %.3f s late (sigma %.4f s) against the positions of the same fixes and are not used",
                            f.clocks.velocity.value, f.clocks.velocity.sigma));
}

/// A given attitude against the smoothed one, which it is part of: the difference has the variance given^2 - smoothed^2.
void judge_given(const InsFindings& f, AlignmentFound& alignment, Warnings& warnings) {
  if (f.alignment.method != "given") return;
  const SmoothedNode& first = f.run.nodes.front();
  const core::Geodetic g = core::geodetic_of(first.estimate.nav.position);
  const Matrix3d ned = core::ecef_R_ned(g.latitude, g.longitude);
  const core::Attitude is = core::attitude_of(ned.transpose() * first.estimate.nav.ecef_R_body),
                       given = core::attitude_of(ned.transpose() * f.alignment.ecef_R_body);
  const Vector3d off(core::wrap_pi(given.roll - is.roll), core::wrap_pi(given.pitch - is.pitch), core::wrap_pi(given.heading - is.heading));
  const Vector3d stated = (ned.transpose() * f.alignment.covariance * ned).diagonal().cwiseSqrt();
  const Vector3d smoothed = core::CovarianceSeries::unpack(first.covariance).diagonal().tail<3>().cwiseMax(0.0).cwiseSqrt();
  alignment.given_minus_smoothed = off / core::degree;
  alignment.given_sigma = stated / core::degree;
  constexpr double least = 1.0 / 16;  // records that show little themselves contradict nothing
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double spread = std::sqrt(std::max(least * stated[i] * stated[i], stated[i] * stated[i] - smoothed[i] * smoothed[i]));
    if (std::abs(off[i]) > sure_sigmas * spread)
      warnings.push_back(std::string("the given ") + std::array{"roll", "pitch", "heading"}[static_cast<size_t>(i)] +
                         text(" contradicts the records by %.3f deg, %.1f times its sigma of %.3f deg: check trajectory.ins_gnss.given",
                              std::abs(off[i]) / core::degree, std::abs(off[i]) / spread, stated[i] / core::degree));
  }
}

/// Are the constants as large as their stated sigmas say? The estimate minus nothing has variance stated^2 - sigma^2 if the data sheet is
/// true.
void judge_constants(const InsEstimates& e, Warnings& warnings) {
  double sum = 0, n = 0;
  std::vector<SensorConstant> all{e.gyro_bias, e.accelerometer_bias};
  if (e.gyro_scale) all.push_back(*e.gyro_scale);
  if (e.accelerometer_scale) all.push_back(*e.accelerometer_scale);
  for (const SensorConstant& c : all)
    for (Eigen::Index i = 0; i < 3; ++i) {
      if (c.stated <= 0 || c.sigma[i] > observed_share * c.stated) continue;
      const double z = c.value[i] / std::sqrt(c.stated * c.stated - c.sigma[i] * c.sigma[i]);
      sum += z * z;
      n += 1;
      if (std::abs(z) > sure_sigmas)
        warnings.push_back(std::string(c.name) + " " + "xyz"[i] + " is " + text("%.4g ", c.value[i] / c.unit) + std::string(c.unit_name) +
                           text(", %.1f times its stated sigma of %.4g", std::abs(z), c.stated / c.unit) +
                           ": the IMU is worse than stated (imu_spec), or its axes or units are wrong");
    }
  // Chi-square by Wilson and Hilferty: standard normal of the cube root.
  if (n < 3) return;
  const double z = (std::cbrt(sum / n) - (1 - 2 / (9 * n))) / std::sqrt(2 / (9 * n));
  if (z > 5.0)  // estimates that lean on one another scatter more than independent ones
    warnings.push_back(
        text("the %.0f observed IMU constants are %.2f times their stated sigmas (rms): the IMU is worse than stated (imu_spec); "
             "printed sigmas of the trajectory are too small",
             n, std::sqrt(sum / n)));
  if (z < -3.5)
    warnings.push_back(
        text("the %.0f observed IMU constants are only %.3f of their stated sigmas (rms): the IMU is better than stated (imu_spec); "
             "printed sigmas of the trajectory are too large",
             n, std::sqrt(sum / n)));
}

std::vector<Interruption> judged_gaps(const std::vector<BridgedGap>& gaps, Warnings& warnings) {
  std::vector<Interruption> out;
  double longest = 0;
  for (const BridgedGap& g : gaps) {
    out.push_back({g.start, g.length});
    longest = std::max(longest, g.length);
  }
  if (!gaps.empty())
    warnings.push_back(text("%.0f gaps in the IMU records, the longest of %.4g s, are bridged; those over 0.1 s hold no trajectory",
                            static_cast<double>(gaps.size()), longest));
  return out;
}

FixesUsed judged_fixes(const InsFindings& f, const core::SmootherSeries& s, Warnings& warnings) {
  const Problem& problem = f.problem;
  FixesUsed out{s.fix_time.size(), 0, problem.share, problem.variance};
  for (const double w : s.weight) out.down_weighted += w < 1.0;
  const auto fixes = static_cast<double>(out.used), weighted = static_cast<double>(out.down_weighted);
  if (weighted > outlier_share * fixes + 3)
    warnings.push_back(text("%.0f of %.0f fixes contradict the trajectory and are down-weighted", weighted, fixes));
  if (problem.variance > 1.3)
    warnings.push_back(text("the fixes scatter %.2f times more than stated; their sigmas are raised by that", std::sqrt(problem.variance)));
  if (f.overstated >= too_cautious) {
    out.overstated = f.overstated;
    // At its limit the share says no more than that they are too large by so much.
    warnings.push_back(
        std::string("the stated sigmas of the fixes are ") + (problem.share < largest_share ? "" : "at least ") +
        text("%.1f times too large by their scatter (%.0f %% of their variance would be correlated), and the sigmas of the trajectory "
             "with them, unless the fixes' errors change far more slowly than correlation_time of %.0f s",
             f.overstated, 100 * problem.share, problem.options.correlation_time.value));
  }
  return out;
}

/// The most certain steps, each with its figures, and how many more there are.
void judge_steps(const InsFindings& f, InsFigures& out) {
  constexpr size_t shown = 3;
  std::vector<FixStep> steps = f.problem.steps;
  for (const FixStep& s : steps) out.steps.push_back({s.first, s.size, s.sigma});
  std::stable_sort(steps.begin(), steps.end(), [](const FixStep& a, const FixStep& b) { return a.chi_square > b.chi_square; });
  for (size_t k = 0; k < std::min(shown, steps.size()); ++k) {
    const FixStep& s = steps[k];
    std::string sentence = text("the fixes jump by %.3f m north, %.3f m east, %.3f m down", s.size.x(), s.size.y(), s.size.z()) +
                           text(" at %.3f s of GPS time, %.1f sigmas", s.first, std::sqrt(s.chi_square));
    if (k + 1 == shown && steps.size() > shown)
      sentence += "; " + core::counted(steps.size() - shown, "more step is", "more steps are") + " in the report";
    out.named.push_back({"trajectory.fix_step", std::move(sentence)});
  }
}

std::vector<Interruption> outages_of(const std::vector<double>& fix_time, double first, double last) {
  std::vector<Interruption> out;
  const auto until = [&](double t) {
    if (t - first >= long_outage) out.push_back({first, t - first});
    first = t;
  };
  for (const double t : fix_time) until(t);
  until(last);
  return out;
}

/// NIS of 3 degrees of freedom; the mean of n has the variance 6 / n.
InnovationFigures judged_innovations(const core::SmootherSeries& s, Warnings& warnings) {
  InnovationFigures out;
  Vector3d squares = Vector3d::Zero(), residual = Vector3d::Zero(), lag = Vector3d::Zero();
  double sum = 0, clean = 0;
  for (size_t k = 0; k < s.fix_time.size(); ++k) {
    squares += s.innovation[k].cwiseAbs2();
    residual += s.residual[k].cwiseAbs2();
    if (k) lag += s.innovation[k].cwiseProduct(s.innovation[k - 1]);
    if (s.weight[k] < 1.0) continue;
    sum += s.nis[k];
    ++clean;
  }
  out.mean = clean > 0 ? sum / clean : std::nan("");
  out.band = clean > 0 ? 1.96 * std::sqrt(6 / clean) : std::nan("");
  const double n = static_cast<double>(std::max<size_t>(1, s.fix_time.size()));
  out.rms = (squares / n).cwiseSqrt();
  out.correlation = lag.cwiseQuotient(squares.cwiseMax(1e-30));
  out.residual_rms = (residual / n).cwiseSqrt();
  if (std::abs(out.mean / 3 - 1) > nis_tolerance + out.band)
    warnings.push_back(text("the innovations are %.2f times what the stated sigmas of IMU and GNSS say (mean NIS %.2f of 3): ",
                            std::sqrt(out.mean / 3), out.mean) +
                       (out.mean > 3 ? "a sensor is worse than stated, the lever arm or a time offset is wrong"
                                     : "the fixes are better than stated, printed sigmas are too large"));
  return out;
}

/// Of the forward and the backward pass.
SeparationFigures separation_of(const core::SmootherSeries& s) {
  SeparationFigures out;
  Vector3d squared = Vector3d::Zero(), normed = Vector3d::Zero(), turned = Vector3d::Zero();
  std::vector<double> size;
  for (size_t k = 0; k < s.time.size(); ++k) {
    squared += s.separation[k].cwiseAbs2();
    normed += s.separation[k].cwiseQuotient(s.separation_sigma[k]).cwiseAbs2();
    turned += s.attitude_separation[k].cwiseAbs2();
    size.push_back(s.separation[k].norm());
  }
  const auto count = static_cast<double>(size.size());
  out.rms = (squared / count).cwiseSqrt();
  out.by_sigma = (normed / count).cwiseSqrt();
  out.attitude_rms = (turned / count).cwiseSqrt() / arcsec;
  out.median = core::median(size);
  out.largest = *std::max_element(size.begin(), size.end());
  return out;
}

/// What was estimated of antenna and vehicle, with what contradicts the survey.
void judge_mounting(const InsFindings& f, InsEstimates& out, std::vector<NamedFault>& named, Warnings& warnings) {
  const SmoothedNode& last = f.run.nodes.back();
  const Estimate& e = last.estimate;
  const Layout& l = f.problem.layout;
  if (l.lever >= 0) {
    const Vector3d change = e.lever - f.lever_arm, sigma = last.sigma.segment<3>(l.lever);
    out.lever_arm = {f.lever_arm, e.lever, sigma, f.lever_arm_sigma};
    for (Eigen::Index i = 0; i < 3; ++i) {
      const double spread = std::sqrt(std::max(1e-12, f.lever_arm_sigma * f.lever_arm_sigma - sigma[i] * sigma[i]));
      if (sigma[i] < 0.95 * f.lever_arm_sigma && std::abs(change[i]) > 3.3 * spread)
        named.push_back(
            {"trajectory.lever_arm",
             std::string("the antenna's lever arm ") + std::array{"forward", "right", "down"}[static_cast<size_t>(i)] +
                 text(" is estimated at %.3f m (sigma %.3f m) but stated as %.3f m: check antenna.lever_arm, its sign and its sigma",
                      e.lever[i], sigma[i], f.lever_arm[i])});
    }
  }
  if (l.latency >= 0) {
    out.latency = {e.latency, last.sigma[l.latency]};
    const double stated = f.problem.options.latency_sigma.value;
    if (std::abs(e.latency) > sure_sigmas * stated)
      warnings.push_back(
          text("the fixes' times are off by %.4f s, %.1f times latency_sigma: state antenna.latency or the IMU's time.offset", e.latency,
               std::abs(e.latency) / stated));
  }
  if (l.track >= 0) out.axis = {e.track.x(), e.track.y(), last.sigma[l.track]};
}

/// Of the product: bridged gaps hold none.
SigmaFigures sigmas_of(const InsFindings& f) {
  SigmaFigures out;
  double count = 0;
  for (size_t k = 0; k < f.problem.nodes.size(); ++k) {
    const double t = f.problem.nodes[k].time;
    if (f.problem.path.bridged_within(t - 1e-6, t + 1e-6).seconds > 0) continue;
    ++count;
    const auto c = core::CovarianceSeries::unpack(f.run.nodes[k].covariance).diagonal().cwiseMax(0.0).eval();
    out.position += c.head<3>();
    out.attitude += c.tail<3>();
    out.worst_position = out.worst_position.cwiseMax(c.head<3>().cwiseSqrt());
    out.worst_attitude = out.worst_attitude.cwiseMax(c.tail<3>().cwiseSqrt());
  }
  out.position = (out.position / count).cwiseSqrt();
  out.attitude = (out.attitude / count).cwiseSqrt() / arcsec;
  out.worst_attitude /= arcsec;
  return out;
}

}  // namespace

core::SmootherSeries series_of(const InsFindings& f) {
  core::SmootherSeries s;
  const auto& nodes = f.problem.nodes;
  const Vector3d none = Vector3d::Constant(std::nan(""));
  for (size_t k = 0; k < nodes.size(); ++k) {
    const SmoothedNode& node = f.run.nodes[k];
    const NavState& nav = node.estimate.nav;
    const core::Geodetic g = core::geodetic_of(nav.position);
    const Matrix3d ned = core::ecef_R_ned(g.latitude, g.longitude);
    const FilterNode& forward = f.run.forward[k];
    s.time.push_back(nodes[k].time);
    if (f.backward.empty()) {
      s.separation.push_back(none);
      s.separation_sigma.push_back(none);
      s.attitude_separation.push_back(none);
    } else {
      const FilterNode& back = f.backward[k];
      const Matrix3d covariance = forward.position_covariance + back.position_covariance;
      Vector3d turn = forward.roll_pitch_heading - back.roll_pitch_heading;
      for (double& a : turn) a = core::wrap_pi(a);
      s.separation.push_back(ned.transpose() * (forward.position - back.position));
      s.separation_sigma.push_back((ned.transpose() * covariance * ned).diagonal().cwiseSqrt());
      s.attitude_separation.push_back(turn);
    }
    const core::Attitude a = core::attitude_of(ned.transpose() * nav.ecef_R_body);
    s.heading_forward.push_back(core::wrap_pi(forward.roll_pitch_heading.z() - a.heading));
    s.gyro_bias.push_back(node.estimate.gyro_bias);
    s.gyro_bias_sigma.push_back(node.sigma.segment<3>(Layout::gyro_bias));
    s.accelerometer_bias.push_back(node.estimate.force_bias);
    s.accelerometer_bias_sigma.push_back(node.sigma.segment<3>(Layout::force_bias));
    if (nodes[k].fix < 0) continue;
    const FixOutcome& o = f.run.outcomes[k];
    s.fix_time.push_back(nodes[k].time);
    s.innovation.push_back(o.innovation);
    s.innovation_sigma.push_back(o.innovation_sigma);
    const Vector3d antenna = nav.position + nav.ecef_R_body * node.estimate.lever + node.estimate.latency * nav.velocity;
    s.residual.push_back(ned.transpose() * (f.problem.gnss.position[static_cast<size_t>(nodes[k].fix)] - antenna));
    s.nis.push_back(o.nis);
    s.weight.push_back(o.weight);
  }
  return s;
}

InsReport report_of(const InsFindings& f, const core::SmootherSeries& s) {
  InsReport report;
  InsFigures& r = report.figures;
  Warnings& warnings = report.warnings;
  const auto& nodes = f.problem.nodes;
  r.span = {nodes.front().time, nodes.back().time, f.problem.path.imu.size(), nodes.size(), f.iterations};
  r.gaps = judged_gaps(f.problem.path.gaps, warnings);
  r.clocks = f.clocks;
  judge_clocks(f, r, warnings);
  r.alignment = {f.alignment.method, f.alignment.time, f.alignment.worst_sigma()};
  judge_given(f, r.alignment, warnings);
  for (const Span& still : f.standstills) r.standstill += still.last - still.first;
  r.fixes = judged_fixes(f, s, warnings);
  r.imu_noise_factor = f.problem.roughness;
  if (f.problem.roughness > 1)
    warnings.push_back(
        text("the IMU's records hold %.0f times the stated noise, which is allowed for: vibration, a better grade stated than flown "
             "(imu_spec), or a wrong time offset",
             f.problem.roughness));
  judge_steps(f, r);
  r.outages = outages_of(s.fix_time, nodes.front().time, nodes.back().time);
  r.innovations = judged_innovations(s, warnings);
  if (!f.backward.empty()) r.separation = separation_of(s);
  r.estimates = sensor_constants(f);
  judge_constants(r.estimates, warnings);
  judge_mounting(f, r.estimates, r.named, warnings);
  r.sigma = sigmas_of(f);
  // Heading: what smoothing took away.
  double heading = 0;
  for (const double h : s.heading_forward) heading += h * h;
  r.heading_smoothed_away = std::sqrt(heading / static_cast<double>(nodes.size())) / arcsec;
  if (const double sigma = r.sigma.attitude.z() * arcsec; sigma > 0.2 * core::degree)
    r.named.push_back(
        {"trajectory.heading",
         text("the heading is known to %.2f deg only (rms sigma), so that points 100 m beside the track are uncertain by %.2f m: "
              "the flight has too few changes of speed or course for this IMU",
              sigma / core::degree, 100.0 * sigma)});
  if (f.unsettled > 0)
    warnings.push_back(text("the smoother had not settled after %.0f rounds: the trajectory still moved by %.2f sigmas",
                            static_cast<double>(f.iterations), f.unsettled));
  return report;
}

}  // namespace swath::trajectory
