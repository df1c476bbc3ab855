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

namespace swath::trajectory {
namespace {

using core::Value;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double arcsec = core::degree / 3600, deg_per_hour = core::degree / 3600, micro_g = 9.80665e-6;
constexpr double nis_tolerance = 0.3;   // the mean NIS per degree of freedom may leave 1 by this before it is reported
constexpr double sure_sigmas = 4.0;     // of a constant against its stated sigma
constexpr double observed_share = 0.5;  // a constant counts as observed when its sigma has fallen below this share
constexpr double outlier_share = 0.02;
constexpr double long_outage = 10.0;  // s

std::string text(const char* form, double a, double b = 0, double c = 0, double d = 0) {
  std::array<char, 320> out{};
  std::snprintf(out.data(), out.size(), form, a, b, c, d);
  return out.data();
}

Value list(const Vector3d& v, double unit) {
  Value out = Value::array();
  for (Eigen::Index i = 0; i < 3; ++i) out.push(v[i] / unit);
  return out;
}

/// A sensor constant at the middle of the record, with the sigma it was stated with.
struct Constant {
  const char* name;
  const char* unit_name;
  double unit;
  Vector3d value, sigma;
  double stated;
};

std::vector<Constant> constants(const InsFindings& f) {
  const SmoothedNode& node = f.run.nodes[f.run.nodes.size() / 2];
  const Estimate& e = node.estimate;
  const Layout& l = f.problem.layout;
  const auto sigma = [&node](int row) -> Vector3d { return row < 0 ? Vector3d::Zero() : Vector3d(node.sigma.segment<3>(row)); };
  std::vector<Constant> out;
  out.push_back({"gyro_bias", "deg_per_h", deg_per_hour, e.gyro_bias, sigma(l.gyro_bias),
                 std::hypot(f.spec.gyro_bias.value, f.spec.gyro_drift.value)});
  out.push_back({"accelerometer_bias", "ug", micro_g, e.force_bias, sigma(l.force_bias),
                 std::hypot(f.spec.accelerometer_bias.value, f.spec.accelerometer_drift.value)});
  if (l.gyro_scale >= 0) out.push_back({"gyro_scale", "ppm", 1e-6, e.gyro_scale, sigma(l.gyro_scale), f.spec.gyro_scale.value});
  if (l.force_scale >= 0)
    out.push_back({"accelerometer_scale", "ppm", 1e-6, e.force_scale, sigma(l.force_scale), f.spec.accelerometer_scale.value});
  return out;
}

/// What the clocks show. With gnss_latency the filter has allowed for a small offset.
void judge_clocks(const InsFindings& f, Value& v, Value& warnings) {
  v["clocks"] = f.clocks.to_value();
  const InsGnssOptions& o = f.problem.options;
  if (f.clocks.apart() && !(o.gnss_latency && std::abs(f.clocks.imu.value) < sure_sigmas * o.latency_sigma.value))
    warnings.push(f.clocks.advice());
  if (f.clocks.velocities_lag())
    warnings.push(text("the GNSS velocities are %.3f s late (sigma %.4f s) against the positions of the same fixes and are not used",
                       f.clocks.velocity.value, f.clocks.velocity.sigma));
}

/// A given attitude against the smoothed one, which it is part of: the difference has the variance given^2 - smoothed^2.
void judge_given(const InsFindings& f, Value& alignment, Value& warnings) {
  if (f.alignment.method != "given") return;
  const SmoothedNode& first = f.run.nodes.front();
  const core::Geodetic g = core::geodetic_of(first.estimate.nav.position);
  const Matrix3d ned = core::ecef_R_ned(g.latitude, g.longitude);
  const core::Attitude is = core::attitude_of(ned.transpose() * first.estimate.nav.ecef_R_body),
                       given = core::attitude_of(ned.transpose() * f.alignment.ecef_R_body);
  const Vector3d off(core::wrap_pi(given.roll - is.roll), core::wrap_pi(given.pitch - is.pitch), core::wrap_pi(given.heading - is.heading));
  const Vector3d stated = (ned.transpose() * f.alignment.covariance * ned).diagonal().cwiseSqrt();
  const Vector3d smoothed = core::CovarianceSeries::unpack(first.covariance).diagonal().tail<3>().cwiseMax(0.0).cwiseSqrt();
  alignment["given_minus_smoothed_deg"] = list(off, core::degree);
  alignment["given_sigma_deg"] = list(stated, core::degree);
  constexpr double least = 1.0 / 16;  // records that show little themselves contradict nothing
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double spread = std::sqrt(std::max(least * stated[i] * stated[i], stated[i] * stated[i] - smoothed[i] * smoothed[i]));
    if (std::abs(off[i]) > sure_sigmas * spread)
      warnings.push(std::string("the given ") + std::array{"roll", "pitch", "heading"}[static_cast<size_t>(i)] +
                    text(" contradicts the records by %.3f deg, %.1f times its sigma of %.3f deg: check trajectory.ins_gnss.given",
                         std::abs(off[i]) / core::degree, std::abs(off[i]) / spread, stated[i] / core::degree));
  }
}

/// Are the constants as large as their stated sigmas say? The estimate minus nothing has variance stated^2 - sigma^2 if the data sheet is
/// true.
void judge_constants(const std::vector<Constant>& all, Value& warnings) {
  double sum = 0, n = 0;
  for (const Constant& c : all)
    for (Eigen::Index i = 0; i < 3; ++i) {
      if (c.stated <= 0 || c.sigma[i] > observed_share * c.stated) continue;
      const double z = c.value[i] / std::sqrt(c.stated * c.stated - c.sigma[i] * c.sigma[i]);
      sum += z * z;
      n += 1;
      if (std::abs(z) > sure_sigmas)
        warnings.push(std::string(c.name) + " " + "xyz"[i] + " is " + text("%.4g ", c.value[i] / c.unit) + c.unit_name +
                      text(", %.1f times its stated sigma of %.4g", std::abs(z), c.stated / c.unit) +
                      ": the IMU is worse than stated (imu_spec), or its axes or units are wrong");
    }
  // Chi-square by Wilson and Hilferty: standard normal of the cube root.
  if (n < 3) return;
  const double z = (std::cbrt(sum / n) - (1 - 2 / (9 * n))) / std::sqrt(2 / (9 * n));
  if (z > 5.0)  // estimates that lean on one another scatter more than independent ones
    warnings.push(
        text("the %.0f observed IMU constants are %.2f times their stated sigmas (rms): the IMU is worse than stated (imu_spec); "
             "printed sigmas of the trajectory are too small",
             n, std::sqrt(sum / n)));
  if (z < -3.5)
    warnings.push(
        text("the %.0f observed IMU constants are only %.3f of their stated sigmas (rms): the IMU is better than stated (imu_spec); "
             "printed sigmas of the trajectory are too large",
             n, std::sqrt(sum / n)));
}

}  // namespace

SmootherSeries series_of(const InsFindings& f) {
  SmootherSeries s;
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

core::Value report_of(const InsFindings& f, const SmootherSeries& s) {
  Value v = Value::object(), warnings = Value::array();
  const auto& nodes = f.problem.nodes;
  const size_t fixes = s.fix_time.size();

  Value& span = v["span"];
  span["first_gps_s"] = nodes.front().time;
  span["last_gps_s"] = nodes.back().time;
  span["imu_records"] = static_cast<std::int64_t>(f.problem.path.imu.size());
  span["nodes"] = static_cast<std::int64_t>(nodes.size());
  span["iterations"] = f.iterations;
  v["imu_gaps_bridged"] = Value::array();
  for (const BridgedGap& g : f.problem.path.gaps) {
    Value one = Value::object();
    one["start_gps_s"] = g.start;
    one["length_s"] = g.length;
    v["imu_gaps_bridged"].push(std::move(one));
  }
  if (!f.problem.path.gaps.empty()) {
    double longest = 0;
    for (const BridgedGap& g : f.problem.path.gaps) longest = std::max(longest, g.length);
    warnings.push(text("%.0f gaps in the IMU records, the longest of %.4g s, are bridged; those over 0.1 s hold no trajectory",
                       static_cast<double>(f.problem.path.gaps.size()), longest));
  }

  judge_clocks(f, v, warnings);
  Value& alignment = v["alignment"];
  alignment["method"] = f.alignment.method;
  alignment["at_gps_s"] = f.alignment.time;
  alignment["worst_sigma_deg"] = f.alignment.worst_sigma() / core::degree;
  judge_given(f, alignment, warnings);
  double still = 0;
  for (const Span& span_still : f.standstills) still += span_still.last - span_still.first;
  v["standstill_s"] = still;

  // Fixes and outages.
  Value& gnss = v["fixes"];
  std::int64_t weighted = 0;
  double sum = 0, clean = 0;
  for (size_t k = 0; k < fixes; ++k) {
    weighted += s.weight[k] < 1.0;
    if (s.weight[k] < 1.0) continue;
    sum += s.nis[k];
    ++clean;
  }
  gnss["used"] = static_cast<std::int64_t>(fixes);
  gnss["down_weighted"] = weighted;
  if (static_cast<double>(weighted) > outlier_share * static_cast<double>(fixes) + 3)
    warnings.push(text("%.0f of %.0f fixes contradict the trajectory and are down-weighted", static_cast<double>(weighted),
                       static_cast<double>(fixes)));
  gnss["correlated_share"] = f.problem.share;
  gnss["white_share"] = 1 - f.problem.share;
  gnss["variance_factor"] = f.problem.variance;
  if (f.problem.variance > 1.3)
    warnings.push(text("the fixes scatter %.2f times more than stated; their sigmas are raised by that", std::sqrt(f.problem.variance)));
  v["imu_noise_factor"] = f.problem.roughness;
  if (f.problem.roughness > 1)
    warnings.push(
        text("the IMU's records hold %.0f times the stated noise, which is allowed for: vibration, a better grade stated than flown "
             "(imu_spec), or a wrong time offset",
             f.problem.roughness));
  v["outages"] = Value::array();
  double before = nodes.front().time;
  const auto outage = [&](double until) {
    if (until - before < long_outage) return;
    Value one = Value::object();
    one["start_gps_s"] = before;
    one["length_s"] = until - before;
    v["outages"].push(std::move(one));
  };
  for (const double t : s.fix_time) {
    outage(t);
    before = t;
  }
  outage(nodes.back().time);

  // Innovations: NIS of 3 degrees of freedom; mean of n has the variance 6 / n.
  Value& nis = v["innovations"];
  const double mean = clean > 0 ? sum / clean : std::nan("");
  const double band = clean > 0 ? 1.96 * std::sqrt(6 / clean) : std::nan("");
  nis["mean_nis"] = mean;
  nis["degrees_of_freedom"] = 3;
  nis["band_95"].push(3 - band);
  nis["band_95"].push(3 + band);
  Vector3d squares = Vector3d::Zero(), residual = Vector3d::Zero(), lag = Vector3d::Zero();
  for (size_t k = 0; k < fixes; ++k) {
    squares += s.innovation[k].cwiseAbs2();
    residual += s.residual[k].cwiseAbs2();
    if (k) lag += s.innovation[k].cwiseProduct(s.innovation[k - 1]);
  }
  const double n = static_cast<double>(std::max<size_t>(1, fixes));
  nis["rms_ned_m"] = list((squares / n).cwiseSqrt(), 1);
  nis["correlation_lag_1_ned"] = list(lag.cwiseQuotient(squares.cwiseMax(1e-30)), 1);
  nis["residual_rms_ned_m"] = list((residual / n).cwiseSqrt(), 1);
  if (std::abs(mean / 3 - 1) > nis_tolerance + band)
    warnings.push(text("the innovations are %.2f times what the stated sigmas of IMU and GNSS say (mean NIS %.2f of 3): ",
                       std::sqrt(mean / 3), mean) +
                  (mean > 3 ? "a sensor is worse than stated, the lever arm or a time offset is wrong"
                            : "the fixes are better than stated, printed sigmas are too large"));

  // Separation of the forward and the backward pass.
  if (!f.backward.empty()) {
    Vector3d squared = Vector3d::Zero(), normed = Vector3d::Zero(), turned = Vector3d::Zero();
    double count = 0;
    std::vector<double> size;
    for (size_t k = 0; k < s.time.size(); ++k) {
      squared += s.separation[k].cwiseAbs2();
      normed += s.separation[k].cwiseQuotient(s.separation_sigma[k]).cwiseAbs2();
      turned += s.attitude_separation[k].cwiseAbs2();
      size.push_back(s.separation[k].norm());
      ++count;
    }
    Value& separation = v["separation"];
    separation["rms_ned_m"] = list((squared / count).cwiseSqrt(), 1);
    separation["by_its_sigma_ned"] = list((normed / count).cwiseSqrt(), 1);
    separation["median_m"] = core::median(size);
    separation["largest_m"] = *std::max_element(size.begin(), size.end());
    separation["rms_roll_pitch_heading_arcsec"] = list((turned / count).cwiseSqrt(), arcsec);
  }

  // Estimates.
  const std::vector<Constant> all = constants(f);
  for (const Constant& c : all) {
    Value& one = v["estimates"][c.name];
    one["unit"] = c.unit_name;
    one["value"] = list(c.value, c.unit);
    one["sigma"] = list(c.sigma, c.unit);
    one["stated_sigma"] = c.stated / c.unit;
  }
  judge_constants(all, warnings);
  const SmoothedNode& last = f.run.nodes.back();
  const Layout& l = f.problem.layout;
  if (l.lever >= 0) {
    Value& one = v["estimates"]["lever_arm"];
    const Vector3d change = last.estimate.lever - f.lever_arm, sigma = last.sigma.segment<3>(l.lever);
    one["unit"] = "m";
    one["stated"] = list(f.lever_arm, 1);
    one["stated_sigma"] = f.lever_arm_sigma;
    one["value"] = list(last.estimate.lever, 1);
    one["sigma"] = list(sigma, 1);
    for (Eigen::Index i = 0; i < 3; ++i) {
      const double spread = std::sqrt(std::max(1e-12, f.lever_arm_sigma * f.lever_arm_sigma - sigma[i] * sigma[i]));
      if (sigma[i] < 0.95 * f.lever_arm_sigma && std::abs(change[i]) > 3.3 * spread)
        warnings.push(std::string("the antenna's lever arm ") + std::array{"forward", "right", "down"}[static_cast<size_t>(i)] +
                      text(" is estimated at %.3f m (sigma %.3f m) but stated as %.3f m: check antenna.lever_arm, its sign and its sigma",
                           last.estimate.lever[i], sigma[i], f.lever_arm[i]));
    }
  }
  if (l.latency >= 0) {
    Value& one = v["estimates"]["gnss_latency"];
    one["unit"] = "s";
    one["value"] = last.estimate.latency;
    one["sigma"] = last.sigma[l.latency];
    one["meaning"] = "to be added to the fixes' times";
    const double stated = f.problem.options.latency_sigma.value;
    if (std::abs(last.estimate.latency) > sure_sigmas * stated)
      warnings.push(text("the fixes' times are off by %.4f s, %.1f times latency_sigma: state antenna.latency or the IMU's time.offset",
                         last.estimate.latency, std::abs(last.estimate.latency) / stated));
  }
  if (l.track >= 0) {
    Value& one = v["estimates"]["vehicle_axis"];
    one["unit"] = "deg";
    one["azimuth"] = last.estimate.track.x() / core::degree;
    one["elevation"] = last.estimate.track.y() / core::degree;
    one["sigma"] = last.sigma[l.track] / core::degree;
  }

  // Sigmas of the product.
  Vector3d position = Vector3d::Zero(), attitude = Vector3d::Zero(), worst_position = Vector3d::Zero(), worst_attitude = Vector3d::Zero();
  double count = 0;
  for (size_t k = 0; k < nodes.size(); ++k) {
    if (f.problem.path.bridged_within(nodes[k].time - 1e-6, nodes[k].time + 1e-6).seconds > 0) continue;  // no trajectory there
    const SmoothedNode& node = f.run.nodes[k];
    ++count;
    const auto c = core::CovarianceSeries::unpack(node.covariance).diagonal().cwiseMax(0.0).eval();
    position += c.head<3>();
    attitude += c.tail<3>();
    worst_position = worst_position.cwiseMax(c.head<3>().cwiseSqrt());
    worst_attitude = worst_attitude.cwiseMax(c.tail<3>().cwiseSqrt());
  }
  Value& sigma = v["sigma"];
  sigma["rms_ned_m"] = list((position / count).cwiseSqrt(), 1);
  sigma["largest_ned_m"] = list(worst_position, 1);
  sigma["rms_roll_pitch_heading_arcsec"] = list((attitude / count).cwiseSqrt(), arcsec);
  sigma["largest_roll_pitch_heading_arcsec"] = list(worst_attitude, arcsec);
  // Heading: what smoothing took away.
  double heading = 0;
  for (const double h : s.heading_forward) heading += h * h;
  v["heading_smoothed_away_rms_arcsec"] = std::sqrt(heading / static_cast<double>(nodes.size())) / arcsec;
  if (std::sqrt(attitude.z() / count) > 0.2 * core::degree)
    warnings.push(text("the heading is known to %.2f deg only (rms sigma): the flight has too few changes of speed or course for this IMU",
                       std::sqrt(attitude.z() / count) / core::degree));
  if (f.unsettled > 0)
    warnings.push(text("the smoother had not settled after %.0f rounds: the trajectory still moved by %.2f sigmas",
                       static_cast<double>(f.iterations), f.unsettled));
  v["warnings"] = std::move(warnings);
  return v;
}

}  // namespace swath::trajectory
