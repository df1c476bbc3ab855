// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Dellaert and Kaess 2017 on the error model of trajectory/ins (Groves 2013). The IMU's
// records of an interval are summed to one transition and one covariance (preintegration, Lupton and Sukkarieh 2012), anew about each
// linearisation instead of by derivatives: the sum is cheap beside the solution. Deviations: of a fix weighed down only the diagonal
// (north, east, down) of its innovation's covariance is kept; a velocity that was weighed down is so by its own covariance; standstill and
// wheels keep their full weight.
#include "calib/network/navigation_factors.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/parallel.h"
#include "trajectory/ins/ins_start.h"

namespace swath::calib {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using trajectory::Layout;
using trajectory::Observation;

// Least noise of a passage, a thousandth of the best IMU's or less: a perfect one would leave nothing to weigh by. Sigmas.
constexpr double least_position = 1e-7, least_velocity = 1e-7;      // m, m/s
constexpr double least_attitude = 1e-9;                             // rad
constexpr double least_gyro_bias = 1e-13, least_force_bias = 1e-9;  // rad/s, m/s^2
constexpr double least_fix = 1e-6;                                  // of its sigma
constexpr double least_of_prior = 1e-12;                            // of any state: m, m/s, rad, s

constexpr int passages_at_a_time = 1024;  // held until they are visited
constexpr size_t passages_of_a_part = 32;

VectorXd floor_of(const FlightStates& states, const Layout& l) {
  VectorXd out(static_cast<Eigen::Index>(states.moving().size()));
  for (size_t i = 0; i < states.moving().size(); ++i) {
    const int row = states.moving()[i];
    const double sigma = row < l.velocity         ? least_position
                         : row < l.attitude       ? least_velocity
                         : row < l.gyro_bias      ? least_attitude
                         : row < l.force_bias     ? least_gyro_bias
                         : row < l.force_bias + 3 ? least_force_bias
                                                  : least_fix;
    out[static_cast<Eigen::Index>(i)] = sigma * sigma;
  }
  return out;
}

void add_instant(std::vector<NetworkNormals::Part>& parts, int instant, const MatrixXd& moving) {
  parts.emplace_back(FlightStates::pose(instant), moving.leftCols(FlightStates::pose_size));
  parts.emplace_back(FlightStates::motion(instant), moving.rightCols(moving.cols() - FlightStates::pose_size));
}

/// Columns of a design over the layout, those of an instant and those of the constants; the calibration has none.
std::vector<NetworkNormals::Part> parts_of(const FlightStates& states, int instant, const MatrixXd& design) {
  MatrixXd common = MatrixXd::Zero(design.rows(), states.calibration_first() + states.calibration_size());
  common.leftCols(states.calibration_first()) = design(Eigen::all, states.constant());
  std::vector<NetworkNormals::Part> out;
  add_instant(out, instant, design(Eigen::all, states.moving()));
  out.emplace_back(states.common(), std::move(common));
  return out;
}

template <int Rows>
void visit_observation(NavigationKind kind, const Observation<Rows>& o, const FlightStates& states, int instant,
                       const NavigationVisit& visit) {
  const Eigen::Matrix<double, Rows, Rows> weight = o.noise.inverse();
  visit(kind, parts_of(states, instant, o.design), 0.5 * (weight + weight.transpose()), o.residual);
}

void visit_start(const FlightStates& states, const trajectory::Estimate& first, const NavigationPrior& prior,
                 const NavigationVisit& visit) {
  const auto n = prior.covariance.rows();
  const MatrixXd W = information_of(prior.covariance, VectorXd::Constant(n, least_of_prior * least_of_prior));
  visit(NavigationKind::start, parts_of(states, 0, MatrixXd::Identity(n, n)), W, prior.mean(first));
}

/// The equation e_k+1 = transition e_k + (carried less reference) + noise.
struct PassageEquation {
  std::vector<NetworkNormals::Part> parts;
  MatrixXd W;
  VectorXd apart;
  std::optional<Vector3d> rate;
};

PassageEquation passage_equation(const FlightStates& states, int to, const trajectory::Passage& passage,
                                 const trajectory::Estimate& reference, const Layout& l, const VectorXd& floor) {
  const std::vector<int>& moving = states.moving();
  const auto n = static_cast<Eigen::Index>(moving.size());
  const trajectory::StateMatrix noise = passage.noise();
  const trajectory::StateVector apart = passage.carried.minus(reference, l);
  const MatrixXd W = information_of(noise(moving, moving), floor);
  std::vector<NetworkNormals::Part> parts = parts_of(states, to - 1, -passage.transition(moving, Eigen::all));
  add_instant(parts, to, MatrixXd::Identity(n, n));
  return {std::move(parts), W, apart(moving), passage.rate};
}

/// Passages to the instants [first, last), each by itself.
std::vector<PassageEquation> passage_equations(const trajectory::Problem& problem, const FlightStates& states,
                                               const std::vector<trajectory::Estimate>& estimates, const VectorXd& floor, int first,
                                               int last) {
  std::vector<PassageEquation> out(static_cast<size_t>(last - first));
  core::in_parallel(out.size(), passages_of_a_part, [&](size_t begin, size_t end) {
    trajectory::ImuWalk walk(problem.path, problem.nodes[static_cast<size_t>(first) + begin - 1].time);
    for (size_t i = begin; i < end; ++i) {
      const size_t at = static_cast<size_t>(first) + i;
      const trajectory::Passage passage = passage_to(problem, estimates[at - 1], walk, problem.nodes[at].time);
      out[i] = passage_equation(states, static_cast<int>(at), passage, estimates[at], problem.layout, floor);
    }
  });
  return out;
}

void weigh_down(Observation<3>& position, const trajectory::FixOutcome& outcome, const Vector3d& place) {
  if (outcome.weight >= 1.0) return;
  const Eigen::Matrix3d ned = trajectory::ned_at(place);
  position.noise += (1.0 / outcome.weight - 1.0) * (ned * outcome.innovation_sigma.cwiseAbs2().asDiagonal() * ned.transpose());
}

/// Standstill and wheels follow one another as in the filter.
class VirtualClock {
 public:
  bool due(double time) const { return std::abs(time - last_) >= trajectory::virtual_interval; }
  void used(double time) { last_ = time; }

 private:
  double last_ = -1e300;
};

void visit_measured(const trajectory::Problem& problem, const FlightStates& states, int instant, const trajectory::Estimate& at,
                    const Vector3d& rate, const trajectory::FixOutcome* outcome, VirtualClock& clock, const NavigationVisit& visit) {
  const trajectory::Node& node = problem.nodes[static_cast<size_t>(instant)];
  if (node.fix >= 0) {
    const auto k = static_cast<size_t>(node.fix);
    Observation<3> position = observed_position(problem, k, at, rate);
    if (outcome) weigh_down(position, *outcome, problem.gnss.position[k]);
    visit_observation(NavigationKind::position, position, states, instant, visit);
    if (auto velocity = observed_velocity(problem, k, at, rate)) {
      if (outcome) velocity->noise *= std::max(1.0, outcome->velocity_nis / problem.gate);
      visit_observation(NavigationKind::velocity, *velocity, states, instant, visit);
    }
  }
  if (!clock.due(node.time)) return;
  if (node.still) {
    visit_observation(NavigationKind::standstill, observed_standstill(problem, at), states, instant, visit);
    clock.used(node.time);
  } else if (problem.layout.track >= 0) {
    if (const auto wheels = observed_wheels(problem, at, rate)) {
      visit_observation(NavigationKind::wheels, *wheels, states, instant, visit);
      clock.used(node.time);
    }
  }
}

}  // namespace

NavigationPrior prior_of(const trajectory::SmoothedFlight& flight) {
  const auto mean = [stated = flight.stated, layout = flight.layout, given = flight.attitude_given](const trajectory::Estimate& about) {
    return trajectory::stated_mean(stated, about, layout, given);
  };
  return {flight.covariance, mean};
}

void each_navigation(const trajectory::Problem& problem, const FlightStates& states, const std::vector<trajectory::Estimate>& estimates,
                     const std::vector<trajectory::FixOutcome>& outcomes, const NavigationPrior& prior, const NavigationVisit& visit) {
  visit_start(states, estimates.front(), prior, visit);
  const VectorXd floor = floor_of(states, problem.layout);
  VirtualClock clock;
  Vector3d rate = Vector3d::Zero();
  const auto measured = [&](int k) {
    const auto at = static_cast<size_t>(k);
    visit_measured(problem, states, k, estimates[at], rate, outcomes.empty() ? nullptr : &outcomes[at], clock, visit);
  };
  measured(0);
  for (int first = 1; first < states.instants(); first += passages_at_a_time) {
    const int last = std::min(states.instants(), first + passages_at_a_time);
    const std::vector<PassageEquation> passages = passage_equations(problem, states, estimates, floor, first, last);
    for (int k = first; k < last; ++k) {
      const PassageEquation& p = passages[static_cast<size_t>(k - first)];
      if (p.rate) rate = *p.rate;
      visit(NavigationKind::imu, p.parts, p.W, p.apart);
      measured(k);
    }
  }
}

void add_navigation(const trajectory::Problem& problem, const FlightStates& states, const std::vector<trajectory::Estimate>& estimates,
                    const std::vector<trajectory::FixOutcome>& outcomes, const NavigationPrior& prior, NetworkNormals& into) {
  each_navigation(problem, states, estimates, outcomes, prior,
                  [&into](NavigationKind, const std::vector<NetworkNormals::Part>& parts, const MatrixXd& weight, const VectorXd& left) {
                    into.add(parts, weight, left);
                  });
}

}  // namespace swath::calib
