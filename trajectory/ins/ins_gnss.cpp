// SPDX-License-Identifier: GPL-3.0-or-later
// Error-state filter and smoother after Groves 2013 (chapters 14 and 16) and Bierman 1973; alignment in motion after Wu and Pan 2013.
// The first pass feeds corrections back; the next ones are linearised about the smoothed trajectory before (Bell 1994: the iterated
// smoother is Gauss and Newton's method), so that what the filter did not know in its first minutes leaves no trace. Deviation: the bias
// drift is a random walk (see ProcessNoise).
// Over 400 lines: the steps from records to the smoothed run stand in one place, each a short function.
#include "trajectory/ins/ins_gnss.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/config/units.h"
#include "core/distributions.h"
#include "core/error.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "core/records/gnss_columns.h"
#include "core/records/imu_columns.h"
#include "core/time_gap.h"
#include "trajectory/ins/alignment.h"
#include "trajectory/ins/fix_steps.h"
#include "trajectory/ins/ins_noise.h"
#include "trajectory/ins/ins_output.h"
#include "trajectory/ins/ins_problem.h"
#include "trajectory/ins/ins_report.h"
#include "trajectory/ins/ins_start.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double longest_lead = 120.0;  // s of IMU records kept before the first fix and after the last
constexpr double most_rate = 2.0;       // rad/s, rms over the record
constexpr int most_iterations = 8;
constexpr double settled = 0.05;    // sigmas by which the trajectory may still move
constexpr double first_gate = 1e5;  // NIS in the first pass, whose start may be degrees off

std::string seconds(double t) { return core::format_number(std::round(t * 1000) / 1000); }

/// An IMU whose numbers cannot be those of a survey: units or axes.
void require_plausible(const core::ImuData& imu) {
  Vector3d force = Vector3d::Zero();
  double turn = 0, length = 0, rate2 = 0;
  for (size_t k = 0; k < imu.size(); ++k) {
    if (!imu.angle[k].allFinite() || !imu.velocity[k].allFinite() || !std::isfinite(imu.time[k]))
      throw core::Error("a value is not finite", "IMU record " + std::to_string(k + 1),
                        "such records must be left out before the smoother");
    force += imu.velocity[k];
    length += imu.step[k];
    turn += imu.angle[k].norm();
    rate2 += imu.angle[k].squaredNorm() / imu.step[k];
  }
  force /= length;
  const double rate = std::sqrt(rate2 / length);
  if (rate > most_rate)
    throw core::Error("the gyros turn by " + seconds(rate) + " rad/s (rms): no carrier does", "IMU records",
                      "are the angles in degrees? state imu.angle_unit");
  if (force.norm() < 5.0 || force.norm() > 15.0)
    throw core::Error("the mean specific force is " + seconds(force.norm()) + " m/s2, which is not gravity", "IMU records",
                      "state imu.acceleration_unit and imu.kind");
  if (-force.z() < 0.5 * force.norm())
    throw core::Error("gravity lies along (" + seconds(force.x()) + ", " + seconds(force.y()) + ", " + seconds(force.z()) +
                          ") m/s2 of forward, right, down, where (0, 0, -9.8) is expected",
                      "IMU records", "state imu.axes or the mounting's roll, pitch and heading");
}

void require_finite(const core::GnssData& gnss) {
  for (size_t k = 0; k < gnss.size(); ++k)
    if (!gnss.position[k].allFinite() || !gnss.covariance[k].allFinite() || !std::isfinite(gnss.time[k]))
      throw core::Error("a position, covariance or time is not finite", "GNSS fix " + std::to_string(k + 1),
                        "such fixes must be left out before the smoother");
}

/// The fixes within the IMU's record; the record cut to their neighbourhood.
struct Trimmed {
  core::ImuData imu;
  core::GnssData gnss;
};

template <class T>
void keep(std::vector<T>& v, size_t first, size_t last) {
  if (v.empty()) return;
  v.erase(v.begin() + static_cast<std::ptrdiff_t>(last), v.end());
  v.erase(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(first));
}

Trimmed trim(core::ImuData imu, core::GnssData gnss) {
  if (imu.size() < 10) throw core::Error("too few IMU records: " + std::to_string(imu.size()), "IMU records", "give a longer record");
  if (gnss.size() < 4) throw core::Error("too few fixes: " + std::to_string(gnss.size()), "GNSS fixes", "four are the least");
  const double begin = imu.time.front() - imu.step.front(), end = imu.time.back();
  const auto first = static_cast<size_t>(std::lower_bound(gnss.time.begin(), gnss.time.end(), begin) - gnss.time.begin());
  const auto last = static_cast<size_t>(std::upper_bound(gnss.time.begin(), gnss.time.end(), end) - gnss.time.begin());
  if (last > first && last < first + 4)
    throw core::Error("only " + core::counted(last - first, "fix lies", "fixes lie") + " within the IMU's record from " + seconds(begin) +
                          " to " + seconds(end) + " s GPS time, four are the least",
                      "trajectory.ins_gnss", "give longer records");
  const double apart = 0.5 * (begin + end - gnss.time.front() - gnss.time.back());
  const std::string gap = core::usual_time_gap(apart, end - begin + gnss.time.back() - gnss.time.front());
  if (last <= first)
    throw core::Error("IMU and GNSS do not overlap: IMU from " + seconds(begin) + " to " + seconds(end) + ", fixes from " +
                          seconds(gnss.time.front()) + " to " + seconds(gnss.time.back()) + " s GPS time",
                      "trajectory.ins_gnss", gap.empty() ? "check the time scales, weeks and dates of both" : gap);
  core::for_each_gnss_column([&](auto member) { keep(gnss.*member, first, last); });
  const auto& t = imu.time;
  const auto imu_first = static_cast<size_t>(std::lower_bound(t.begin(), t.end(), gnss.time.front() - longest_lead) - t.begin());
  const auto imu_last = static_cast<size_t>(std::upper_bound(t.begin(), t.end(), gnss.time.back() + longest_lead) - t.begin());
  core::for_each_imu_column([&](auto member) { keep(imu.*member, imu_first, imu_last); });
  return {std::move(imu), std::move(gnss)};
}

/// The path's ends, every fix, and instants between where they are farther apart than `spacing`: between nodes residuals of the
/// mechanisation are linear in time.
std::vector<Node> nodes_of(const ImuPath& path, const core::GnssData& gnss, const std::vector<Span>& standstills, double spacing) {
  std::vector<Node> out{{path.begin(), -1, false}};
  const auto fill_to = [&out, spacing](double t) {
    const double from = out.back().time;
    const double n = std::ceil((t - from) / spacing - 1e-6);
    for (double i = 1; i < n; ++i) out.push_back({from + (t - from) * i / n, -1, false});
  };
  constexpr double same = 1e-6;  // s
  for (size_t k = 0; k < gnss.size(); ++k) {
    if (gnss.time[k] < out.back().time + same) {
      if (out.back().fix < 0) out.back().fix = static_cast<std::int32_t>(k);
      continue;
    }
    fill_to(gnss.time[k]);
    out.push_back({gnss.time[k], static_cast<std::int32_t>(k), false});
  }
  if (path.end() > out.back().time + same) {
    fill_to(path.end());
    out.push_back({path.end(), -1, false});
  }
  size_t s = 0;
  for (Node& n : out) {
    while (s < standstills.size() && standstills[s].last < n.time) ++s;
    n.still = s < standstills.size() && n.time >= standstills[s].first;
  }
  return out;
}

/// The largest change of position, velocity or attitude between two runs, in sigmas.
double moved(const SmootherRun& now, const std::vector<Estimate>& before, const Layout& l) {
  double most = 0;
  for (size_t k = 0; k < before.size(); ++k) {
    const StateVector e = now.nodes[k].estimate.minus(before[k], l);
    if (!e.allFinite()) return std::numeric_limits<double>::infinity();
    for (int i = 0; i < 9; ++i) most = std::max(most, std::abs(e[i]) / std::max(1e-12, now.nodes[k].sigma[i]));
  }
  return most;
}

/// Counts the nodes that the passes come to. How many passes it takes shows only at the end; most records take so many.
class PassCount {
 public:
  PassCount(size_t nodes, const core::OnProgress& progress) : usual_(usual_passes * static_cast<double>(nodes)), progress_(progress) {}
  void operator()() {
    constexpr int at_once = 256;
    if (++done_ % at_once == 0) progress_(core::usual_share(static_cast<double>(done_), usual_), "filter and smoother");
  }

 private:
  static constexpr double usual_passes = 9.0;
  double usual_;
  std::uint64_t done_ = 0;
  const core::OnProgress& progress_;
};

/// The first run, with as much noise of the IMU as its innovations ask for.
template <class Start>
SmootherRun first_run(Problem& problem, const Start& from_scratch) {
  SmootherRun run = run_smoother(problem, from_scratch(), false);
  if (!adapt_imu(problem, run.outcomes)) return run;
  while (adapt_imu(problem, run_forward(problem, from_scratch()))) {
  }
  return run_smoother(problem, from_scratch(), false);
}

void refuse_contradicting(const std::vector<double>& weights) {
  const auto rejected = std::count_if(weights.begin(), weights.end(), [](double w) { return w < 1.0; });
  if (2 * static_cast<size_t>(rejected) > weights.size())
    throw core::Error(std::to_string(rejected) + " of " + std::to_string(weights.size()) + " fixes contradict the IMU",
                      "trajectory.ins_gnss", "check the lever arm's sign, the time scales, imu.angle_unit, imu_spec and the fixes' sigmas");
}

/// The fixes' correlated error at the beginning or the end of the record, where these have another level than most of the time.
void allow_for_level(const Problem& p, bool beginning, StateMatrix& stated) {
  const int fix = p.layout.fix;
  if (fix < 0 || p.steps.empty() || !(p.share > 0.0)) return;
  stated.block<3, 3>(fix, fix).diagonal() += level_variance(p, beginning ? p.steps.front().before : p.steps.back().after);
}

/// All but the records, which their owner gives.
SmoothedFlight left_by(const Problem& p, const SmootherRun& run, const Start& start) {
  SmoothedFlight out;
  out.nodes = p.nodes;
  out.layout = p.layout;
  out.noise = p.noise;
  out.options = p.options;
  out.share = p.share, out.variance = p.variance, out.roughness = p.roughness, out.gate = p.gate;
  out.steps = p.steps;
  for (const SmoothedNode& n : run.nodes) out.estimates.push_back(n.estimate);
  out.outcomes = run.outcomes;
  out.stated = start.estimate;
  out.covariance = widened(start.covariance, run.nodes.front().sigma, start.attitude_given);
  allow_for_level(p, true, out.covariance);
  out.attitude_given = start.attitude_given;
  return out;
}

/// The smoother over records that are in order.
InsGnssResult smooth_path(const ImuPath& path, const core::GnssData& gnss, const core::ImuErrorModel& spec, const Vector3d& lever_arm,
                          double lever_arm_sigma, const InsGnssOptions& options, const ClockFindings& clocks,
                          const core::OnProgress& progress, SmoothedFlight* left) {
  const std::vector<Span> standstills =
      options.zero_velocity || options.alignment != AlignmentMethod::given ? find_standstills(path, gnss, spec) : std::vector<Span>{};
  const std::vector<Node> nodes =
      nodes_of(path, gnss, options.zero_velocity ? standstills : std::vector<Span>{}, options.node_spacing.value);

  const Layout layout(options.scale_factors, options.lever_arm && lever_arm_sigma > 0, options.correlated_share.value_or(1) > 0,
                      options.gnss_latency, options.non_holonomic);
  Problem problem{path, gnss, nodes, layout, ProcessNoise::of(spec, options.correlation_time.value), options};

  const Alignment alignment = align(path, gnss, spec, lever_arm, standstills, options);
  const Start start = start_of(path, gnss, alignment, spec, layout, lever_arm, lever_arm_sigma, options);
  problem.share = options.correlated_share.value_or(usual_share);
  PassCount count(nodes.size(), progress);
  problem.at_node = [&count] { count(); };

  // Repeated about the smoothed trajectory until it stays.
  problem.gate = first_gate;
  const auto from_scratch = [&] { return InsFilter(problem, start.estimate, StateVector::Zero(layout.size), start.covariance, nullptr); };
  SmootherRun run = first_run(problem, from_scratch);
  problem.gate = core::chi_square_limit(options.outlier_probability, 3.0);  // the NIS of a position
  std::vector<Estimate> reference(nodes.size());
  const auto about_with = [&](const Problem& noise, const SmoothedNode& at) {
    const bool attitude = start.attitude_given && &at == &run.nodes.front();  // what is given is that of the beginning
    StateMatrix stated = start.covariance;
    // At the other end nothing is stated of the attitude: 1 rad is more than any error.
    if (start.attitude_given && !attitude) stated.block<3, 3>(Layout::attitude, Layout::attitude).setIdentity();
    allow_for_level(noise, &at == &run.nodes.front(), stated);
    return InsFilter(noise, at.estimate, stated_mean(start.estimate, at.estimate, layout, attitude), widened(stated, at.sigma, attitude),
                     &reference);
  };
  const auto about = [&](const SmoothedNode& at) { return about_with(problem, at); };
  const auto refer = [&] {
    for (size_t k = 0; k < nodes.size(); ++k) reference[k] = run.nodes[k].estimate;
  };
  refer();
  if (!options.correlated_share)
    for (int i = 0; i < most_iterations && adapt_fixes(problem, run_forward(problem, about(run.nodes.front()))); ++i) {
    }
  for (int i = 0; i < most_iterations && add_fix_steps(problem, about(run.nodes.front())); ++i) {
  }
  int iterations = 1;
  double shift = std::numeric_limits<double>::infinity();
  for (; shift > settled && iterations < most_iterations; ++iterations) {
    refer();
    run.errors = {};  // before the next one's: they are large
    run = run_smoother(problem, about(run.nodes.front()));
    shift = moved(run, reference, layout);
  }
  if (!std::isfinite(shift))
    throw core::Error("the filter diverged", "trajectory.ins_gnss", "check units, axes, lever arm and time scales");
  const std::vector<FilterNode> backward = run_backward(problem, about(run.nodes.back()));
  const double overstated = options.correlated_share ? 1.0 : overstatement(problem, [&](const Problem& noise) {
    return run_forward(noise, about_with(noise, run.nodes.front()));
  });

  InsGnssResult result;
  const InsFindings findings{
      problem, run,       backward, spec, alignment, lever_arm, lever_arm_sigma, standstills, iterations, shift > settled ? shift : 0.0,
      clocks,  overstated};
  result.series = series_of(findings);
  refuse_contradicting(result.series.weight);
  result.report = report_of(findings, result.series);
  result.trajectory = trajectory_of(problem, run.nodes, options.output_rate.value);
  result.trajectory.errors = std::move(run.errors);
  if (left) *left = left_by(problem, run, start);
  return result;
}

}  // namespace

InsGnssResult smooth(core::ImuData imu_records, core::GnssData fixes, const core::ImuErrorModel& spec, const Vector3d& lever_arm,
                     double lever_arm_sigma, const InsGnssOptions& stated_options, const StatedClocks& stated,
                     const core::OnProgress& progress, SmoothedFlight* left) {
  require_plausible(imu_records);
  require_finite(fixes);
  InsGnssOptions options = stated_options;
  Trimmed records = trim(std::move(imu_records), std::move(fixes));
  ImuPath path = make_path(std::move(records.imu), options.max_gap.value);
  ClockFindings clocks;
  clocks.stated = stated;
  clocks.imu.reason = clocks.velocity.reason = "not looked for";
  progress(0.0, "clocks");
  if (options.clock_search.value > 0)
    clocks.imu = imu_clock_offset(path, records.gnss, spec, lever_arm, lever_arm_sigma, options.clock_search.value);
  if (records.gnss.has_velocity()) clocks.velocity = velocity_lag(records.gnss);
  options.use_velocity = options.use_velocity && !clocks.velocities_lag();
  try {
    InsGnssResult result = smooth_path(path, records.gnss, spec, lever_arm, lever_arm_sigma, options, clocks, progress, left);
    if (left) left->path = std::move(path), left->gnss = std::move(records.gnss);
    return result;
  } catch (const core::Error& e) {
    if (!clocks.apart()) {
      const std::string leap = leap_seconds_between(path, records.gnss, spec, lever_arm, lever_arm_sigma);
      if (leap.empty()) throw;
      throw core::Error(e.what(), e.where(), leap + (e.hint().empty() ? "" : " Otherwise " + e.hint()), e.code());
    }
    throw core::Error(e.what(), e.where(), clocks.advice() + (e.hint().empty() ? "" : "; otherwise " + e.hint()), e.code());
  }
}

}  // namespace swath::trajectory
