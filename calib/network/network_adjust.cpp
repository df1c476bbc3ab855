// SPDX-License-Identifier: GPL-3.0-or-later
// Rounds of seeking planes with the trajectory as adjusted so far and of Gauss-Newton steps over all instants. Groups of returns are
// weighed only once the trajectory has come to them: at first all of them are far off, and all are right.
#include "calib/network/network_adjust.h"

#include <algorithm>
#include <cmath>

#include "calib/adjust/start_sigmas.h"
#include "calib/network/network.h"
#include "core/error.h"
#include "core/statistics.h"
#include "trajectory/ins/ins_output.h"

namespace swath::calib {
namespace {

using Eigen::VectorXd;

constexpr double planes_settled = 0.2;     // sigmas of all unknowns together
constexpr double steady_returns = 0.005;   // m: planes are found the same way with returns that have moved by less
constexpr double closest_mismatch = 0.05;  // m
constexpr double margin = 0.25;  // s of the trajectory about returns: more than three records at the least output_rate, for a cubic
constexpr double usual_network_rounds = 3.0, search_part = 0.3;
constexpr double first_part = 0.6;  // of the iterations, before groups are weighed
constexpr int most_updates = 12;    // of the surfaces' sigma in one round
constexpr int most_rejections = 4;  // in one round; where planes are sought anew after the first, one is enough in that

std::vector<Parameter> unknown_values(const EstimateOptions& e) {
  const bool wanted[] = {e.roll,         e.pitch,       e.heading,     e.lever_forward, e.lever_right, e.lever_down,
                         e.range_offset, e.range_scale, e.scan_offset, e.scan_scale,    e.latency};
  std::vector<Parameter> out;
  for (int p = boresight_roll; p <= latency; ++p)
    if (wanted[p]) out.push_back(static_cast<Parameter>(p));
  return out;
}

std::vector<double> times_of(const std::vector<trajectory::Node>& nodes) {
  std::vector<double> out;
  for (const trajectory::Node& n : nodes) out.push_back(n.time);
  return out;
}

class NetworkRounds {
 public:
  NetworkRounds(const CalibrationFlight& flight, const trajectory::SmoothedFlight& smoothed, const NetworkOptions& options)
      : flight_(flight),
        smoothed_(smoothed),
        problem_(smoothed.problem()),
        options_(options),
        unknown_(unknown_values(options.estimate)),
        network_(problem_, smoothed.estimates, smoothed.outcomes, prior_of(smoothed), static_cast<int>(unknown_.size())),
        output_(problem_, options.smoother.output_rate.value),
        surface_(options.surface_sigma.value) {
    interpolation_.max_gap.value = std::max(interpolation_.max_gap.value, 2.5 / options.smoother.output_rate.value);
  }

  core::Calibration calibration() const {
    core::Calibration out = flight_.start;
    for (size_t i = 0; i < unknown_.size(); ++i)
      set_value(out, unknown_[i], value_of(flight_.start, unknown_[i]) + network_.calibration()[static_cast<Eigen::Index>(i)]);
    return out;
  }

  /// Through the present estimates, without covariances.
  trajectory::Trajectory trajectory() const { return through(std::vector<char>(network_.estimates().size() - 1, 1)); }
  /// Where the planes' returns are.
  trajectory::Trajectory trajectory(const PlaneFactors& planes) const { return through(planes.intervals(calibration(), margin)); }

  PlaneFactors factors(const TieSet& ties) const {
    return PlaneFactors(ties, flight_.scanner, flight_.sensor, times_of(smoothed_.nodes), unknown_, options_.robust, surface_,
                        problem_.noise.angle, flight_.threads);
  }

  /// Steps until the states stay; true where they did.
  bool iterate(PlaneFactors& planes, int& iterations) {
    for (int i = 0; i < options_.iterations; ++i) {
      const bool weigh = started_weighing_ || i >= static_cast<int>(first_part * options_.iterations);
      const double moved = network_.step([&](NetworkNormals& into) {
        planes.linearise(trajectory(planes), calibration());
        if (weigh) planes.weigh();
        planes.add(network_.states(), into);
        add_start_values(into);
      });
      planes.follow(network_.last_step(), network_.states());
      ++iterations;
      if (moved > planes_settled) continue;
      if (weigh) return true;
      started_weighing_ = true;
    }
    return false;
  }

  /// Solves with the surfaces' sigma and the groups that the residuals bear out; the last solution is inverted. True where it settled.
  /// Groups are tested only once the sigma has settled: with one too small most would look displaced.
  bool adjust(PlaneFactors& planes, int rejections, int& iterations) {
    displaced_ = 0;
    for (int updates = 0;;) {
      const bool settled = iterate(planes, iterations);
      network_.invert();
      test(planes);
      surface_ = planes.surface();
      if (options_.estimate_surface) {
        if (updates == most_updates) return settled;
        if (update_surface(planes, tests_)) {
          ++updates;
          continue;
        }
      }
      if (!options_.snooping.use || rejections-- == 0) return settled;
      const int out = reject_groups(planes, tests_, options_.snooping.alpha, options_.snooping.share);
      if (out == 0) return settled;
      displaced_ += static_cast<std::uint64_t>(out);
    }
  }

  /// Groups that were left out keep the test that showed them.
  void test(const PlaneFactors& planes) {
    PlaneTests now = test_planes(planes, network_.states(), network_.factor(), network_.last_step());
    for (size_t g = 0; g < planes.groups(); ++g)
      if (planes.is_rejected(g)) now.group[g] = tests_.group[g];
    tests_ = std::move(now);
  }

  const PlaneTests& tests() const { return tests_; }
  std::uint64_t displaced() const { return displaced_; }
  std::vector<NetworkComponent> components() const {
    std::vector<double> sigmas;
    for (const Parameter p : unknown_) sigmas.push_back(apriori(p));
    return components_of(network_, tests_, sigmas);
  }
  const FlightStates& states() const { return network_.states(); }
  const Network& network() const { return network_; }
  const std::vector<Parameter>& unknown() const { return unknown_; }
  double apriori(Parameter p) const { return apriori_of(options_.apriori, p); }
  /// Trajectory and biases with their covariances.
  void finish(AdjustedNetwork& out) const {
    const std::vector<trajectory::SmoothedNode> nodes = network_.smoothed();
    out.trajectory = trajectory_of(problem_, nodes, options_.smoother.output_rate.value);
    constexpr int gyro = trajectory::Layout::gyro_bias, force = trajectory::Layout::force_bias;
    for (const trajectory::SmoothedNode& n : nodes)
      out.biases.push_back(
          {n.estimate.nav.time, n.estimate.gyro_bias, n.sigma.segment<3>(gyro), n.estimate.force_bias, n.sigma.segment<3>(force)});
  }

 private:
  trajectory::Trajectory through(const std::vector<char>& intervals) const {
    return trajectory::Trajectory(poses_of(problem_, network_.estimates(), output_, intervals), interpolation_, "calib.network");
  }

  void add_start_values(NetworkNormals& into) const {
    const auto n = static_cast<Eigen::Index>(unknown_.size());
    if (n == 0) return;
    VectorXd information(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double sigma = apriori(unknown_[static_cast<size_t>(i)]);
      information[i] = std::isfinite(sigma) ? 1.0 / (sigma * sigma) : 0.0;
    }
    Eigen::MatrixXd part = Eigen::MatrixXd::Zero(n, into.N.size(states().common()));
    part.rightCols(n).setIdentity();
    into.add({{states().common(), part}}, information.asDiagonal(), -network_.calibration());
  }

  const CalibrationFlight& flight_;
  const trajectory::SmoothedFlight& smoothed_;
  trajectory::Problem problem_;
  const NetworkOptions& options_;
  std::vector<Parameter> unknown_;
  Network network_;
  trajectory::OutputRecords output_;
  double surface_;
  PlaneTests tests_;
  std::uint64_t displaced_ = 0;
  trajectory::TrajectoryOptions interpolation_;
  bool started_weighing_ = false;
};

double robust_scatter(const std::vector<PlaneMisfit>& misfits) {
  std::vector<double> sizes;
  for (const PlaneMisfit& m : misfits)
    if (m.returns > 0 && m.weight > 0) sizes.push_back(std::abs(m.mean));
  return core::mad_to_sigma * core::median(std::move(sizes), 0.0);
}

/// By how much the groups' returns lie elsewhere along their normals than before a round: differences of lines, so that planes may move.
double moved_by(const std::vector<PlaneMisfit>& before, const std::vector<PlaneMisfit>& after) {
  double squares = 0, n = 0;
  for (size_t g = 0; g < after.size(); ++g) {
    if (after[g].returns == 0 || after[g].weight <= 0) continue;
    squares += std::pow(after[g].mean - before[g].mean, 2);
    ++n;
  }
  return n > 0 ? std::sqrt(squares / n) : 0.0;
}

void refuse_without_common_planes(const TieSet& ties, const core::Tally& tally) {
  for (size_t g = 1; g < ties.groups.size(); ++g)
    if (ties.groups[g].plane == ties.groups[g - 1].plane) return;
  refuse_without_planes(tally, "", "calib.network", ", and lie no farther apart than planes.mismatch");
}

/// About the planes as they are.
std::vector<PlaneMisfit> misfits_of(PlaneFactors factors, const trajectory::Trajectory& trajectory, const core::Calibration& calibration) {
  factors.linearise(trajectory, calibration);
  return factors.misfits();
}

/// About planes fitted to the groups that have weight.
std::vector<PlaneMisfit> refitted(PlaneFactors factors, const trajectory::Trajectory& trajectory, const core::Calibration& calibration) {
  factors.fit(trajectory, calibration);
  return misfits_of(std::move(factors), trajectory, calibration);
}

std::vector<VarianceComponent> sigmas_of(const PlaneFactors& factors, const core::SensorSigma& stated, double stated_surface,
                                         const PlaneTests& tests, bool surface_estimated) {
  const SigmaFactor &range = factors.range_factor(), &angle = factors.angle_factor();
  const double angle_sigma = std::hypot(stated.scan_angle.value, stated.beam_divergence.value / 4.0);
  const double surface = stated_surface > 0.0 ? factors.surface() / stated_surface : not_known;
  return {{"range", stated.range.value, range.factor, range.redundancy, range.estimated},
          {"angle", angle_sigma, angle.factor, angle.redundancy, angle.estimated},
          {"surface", stated_surface, surface, tests.means.redundancy, surface_estimated}};
}

}  // namespace

AdjustedNetwork adjust_network(const CalibrationFlight& flight, const trajectory::SmoothedFlight& smoothed, const NetworkOptions& options,
                               core::Tally& tally, const core::OnProgress& progress) {
  std::vector<SurveyedTarget> targets;
  std::copy_if(flight.targets.begin(), flight.targets.end(), std::back_inserter(targets),
               [](const SurveyedTarget& t) { return t.use == io::ControlUse::control; });
  NetworkRounds rounds(flight, smoothed, options);
  AdjustedNetwork out;
  TiePlaneOptions planes = sized(options.planes, flight.scale);
  core::Tally of_round;
  for (out.rounds = 1;; ++out.rounds) {
    of_round = {};
    const std::string round = "round " + std::to_string(out.rounds);
    progress(core::usual_share(out.rounds - 1, usual_network_rounds), round + ": planes");
    const auto seek = [&](const trajectory::Trajectory& now) {
      out.ties = find_tie_planes(flight.shots, flight.scanner, rounds.calibration(), now, flight.frame, targets, planes, of_round);
    };
    if (out.rounds == 1)
      seek(*flight.trajectory);
    else
      seek(rounds.trajectory());
    refuse_without_common_planes(out.ties, of_round);
    progress(core::usual_share(out.rounds - 1 + search_part, usual_network_rounds), round + ": adjustment");
    PlaneFactors factors = rounds.factors(out.ties);
    const core::Calibration start = rounds.calibration();
    const trajectory::Trajectory now = rounds.trajectory(factors);
    factors.fit(now, start);
    out.settled = rounds.adjust(factors, out.rounds == 1 && options.rounds > 1 ? 1 : most_rejections, out.iterations);
    const trajectory::Trajectory moved = rounds.trajectory(factors);
    out.after = misfits_of(factors, moved, rounds.calibration());
    out.last_move = moved_by(refitted(factors, now, start), refitted(factors, moved, rounds.calibration()));
    out.left_out = factors.left_out();
    out.noise_factor = factors.noise_factor();
    out.surface_sigma = factors.surface();
    out.surface_estimated = options.estimate_surface && surface_is_known(rounds.tests());
    out.sigmas = sigmas_of(factors, flight.sensor, options.surface_sigma.value, rounds.tests(), out.surface_estimated);
    out.range_factor = factors.range_factor().factor;
    out.angle_factor = factors.angle_factor().factor;
    out.displaced = rounds.displaced();
    out.tests = rounds.tests();
    out.planes = factors.planes();
    planes.mismatch.value =
        std::clamp(3 * robust_scatter(out.after), std::min(closest_mismatch, planes.mismatch.value), planes.mismatch.value);
    const bool last = out.rounds == options.rounds || (out.rounds > 1 && out.last_move < steady_returns);
    if (!last) continue;
    out.before = refitted(factors, *flight.trajectory, flight.start);
    out.components = rounds.components();
    break;
  }
  tally.add(of_round);
  progress(core::usual_share(usual_network_rounds, usual_network_rounds), "covariances");
  const Network& network = rounds.network();
  rounds.finish(out);
  out.calibration = rounds.calibration();
  out.covariance = network.calibration_covariance();
  for (size_t i = 0; i < rounds.unknown().size(); ++i) {
    const Parameter p = rounds.unknown()[i];
    const auto at = static_cast<Eigen::Index>(i);
    out.values.push_back(
        {p, value_of(flight.start, p), rounds.apriori(p), value_of(out.calibration, p), std::sqrt(std::max(0.0, out.covariance(at, at)))});
  }
  out.instants = smoothed.nodes.size();
  out.unknowns = static_cast<std::uint64_t>(network.last_step().size());
  return out;
}

PlaneAgreement agreement_on_planes(const AdjustedNetwork& network) {
  PlaneAgreement out;
  const std::vector<TieGroup>& groups = network.ties.groups;
  for (size_t i = 0; i < groups.size(); ++i)
    for (size_t j = i + 1; j < groups.size() && groups[j].plane == groups[i].plane; ++j) {
      const PlaneMisfit &a = network.after[i], &b = network.after[j];
      if (groups[i].line == groups[j].line || a.returns == 0 || b.returns == 0 || a.weight <= 0 || b.weight <= 0) continue;
      if (network.before[i].returns == 0 || network.before[j].returns == 0) continue;
      ++out.pairs;
      out.before += std::pow(network.before[i].mean - network.before[j].mean, 2);
      out.after += std::pow(a.mean - b.mean, 2);
    }
  if (out.pairs > 0) {
    out.before = std::sqrt(out.before / static_cast<double>(out.pairs));
    out.after = std::sqrt(out.after / static_cast<double>(out.pairs));
  }
  return out;
}

}  // namespace swath::calib
