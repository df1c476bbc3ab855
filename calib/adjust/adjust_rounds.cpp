// SPDX-License-Identifier: GPL-3.0-or-later
// Gauss-Newton with robust weights. The order matters: planes are refitted first, for the start values' errors are common to all returns of
// a group; start values are tested against the flight before the variances are estimated, which would explain any contradiction; control
// enters after the strips agree among themselves, so that control in another datum is seen for what it is; displaced groups go one batch at
// a time, and after each the variances are estimated anew.
#include "calib/adjust/adjust_rounds.h"

#include <algorithm>
#include <cmath>

#include "calib/adjust/start_sigmas.h"
#include "core/statistics.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double steady_step = 0.01;    // of an unknown's sigma
constexpr double steady_factor = 0.03;  // of a sigma's factor
constexpr double least_range = 1e-3;    // m: a sigma of zero would leave nothing to weigh by
constexpr int snooping_rounds = 6, batches = 8;
// What holds a free unknown that nothing determines, in useful sigmas: the equations stay solvable, the value is refused.
constexpr double free_sigma = 1e4;

}  // namespace

AdjustRounds::AdjustRounds(const TieProblem& problem, const core::Calibration& start, const core::SensorSigma& noise, VectorXd apriori,
                           const VectorXd& limit, const AdjustOptions& options)
    : problem_(&problem), stated_(&noise), options_(&options), start_(start) {
  state.calibration = start;
  state.correction = VectorXd::Zero(problem.knots->size());
  state.planes = problem.ties->planes;
  state.roughness.assign(state.planes.size(), 0.0);
  apriori_ = std::move(apriori);
  free_ = (free_sigma * limit).cwiseAbs2().cwiseInverse();
  information_ = apriori_.cwiseAbs2().cwiseInverse().cwiseMax(free_);
  contradiction = VectorXd::Zero(apriori_.size());
  use.group.assign(problem.ties->groups.size(), 1);
  use.control.assign(control_rows(state.planes, 1.0).size(), 0);
}

TieNoise AdjustRounds::noise() const {
  return {factors.range.factor * std::max(least_range, stated_->range.value), factors.angle.factor * stated_->scan_angle.value,
          factors.angle.factor * stated_->beam_divergence.value / 4.0, stated_->time.value};
}

void AdjustRounds::fit_planes() {
  before.assign(problem_->ties->groups.size(), 0.0);
  // Twice: the second time the normals are right and the planes' own slopes do not mix with their weights.
  for (int i = 0; i < 2; ++i) {
    pass = linearise(*problem_, state, noise(), scale);
    scale = pass.scale;
    const TieSystem system(*problem_, pass.blocks, {}, 0.0);
    for (std::uint32_t k = 0; k < system.planes(); ++k) {
      Eigen::Matrix3d N = Eigen::Matrix3d::Zero();
      Vector3d b = Vector3d::Zero();
      const auto [first, last] = system.groups_of(k);
      for (size_t g = first; g < last; ++g) {
        N += system.bare(g).N.bottomRightCorner<3, 3>();
        b += system.bare(g).b.tail<3>();
      }
      N.diagonal().array() += 1e-3;  // 1 / m^2: holds planes without returns
      const Vector3d d = -N.ldlt().solve(b);
      for (size_t g = first; g < last; ++g) {
        const GroupBlock& block = system.bare(g);
        const auto at = static_cast<Eigen::Index>(block.index.size());
        if (block.used > 0) before[g] = -(block.b[at] + block.N.col(at).tail<3>().dot(d)) / block.weight();
      }
      move_plane(state.planes[k], d);
    }
  }
}

void AdjustRounds::set_roughness() {
  // A plane's stated roughness holds the records' noise. What is typical of all planes is noise, what goes beyond is the plane's.
  const size_t planes = state.planes.size();
  std::vector<double> noise_of(planes, 0.0), count(planes, 0.0), ratios;
  for (size_t g = 0; g < pass.blocks.size(); ++g) {
    const std::uint32_t k = problem_->ties->groups[g].plane;
    noise_of[k] += pass.blocks[g].used * pass.blocks[g].noise;
    count[k] += pass.blocks[g].used;
  }
  for (size_t k = 0; k < planes; ++k)
    if (count[k] > 0.0 && state.planes[k].roughness > 0.0)
      ratios.push_back(state.planes[k].roughness * state.planes[k].roughness * count[k] / noise_of[k]);
  const double typical = core::median(ratios, 1.0);
  for (size_t k = 0; k < planes; ++k) {
    if (count[k] == 0.0) continue;
    const double own = state.planes[k].roughness * state.planes[k].roughness - typical * noise_of[k] / count[k];
    state.roughness[k] = std::sqrt(std::max(0.0, own));
  }
}

void AdjustRounds::sum_up(Inverse keep) {
  normals.emplace(system_->sum(use, rests));
  add_prior(*prior, *normals);
  solution = {};  // its inverse is as large as the new one
  solution = solve(*system_, *normals, rests, keep);
  if (solution.solved) tests = tests_of(*system_, solution, rests, use);
}

void AdjustRounds::solve_here(Inverse keep) {
  pass = linearise(*problem_, state, noise(), scale);
  system_ = std::make_unique<TieSystem>(*problem_, pass.blocks, control_rows(state.planes, factors.control.factor), surface());
  VectorXd departure = VectorXd::Zero(information_.size());
  for (Eigen::Index i = 0; i < information_.size(); ++i)
    departure[i] = value_of(state.calibration, problem_->globals[i]) - value_of(start_, problem_->globals[i]);
  prior.emplace(*problem_, system_->nodes(), factors.of_position(), factors.of_attitude(), state.correction, information_, departure);
  sum_up(keep);
}

bool AdjustRounds::round(bool variances) {
  ++rounds;
  solve_here();
  scale = pass.scale;
  if (!solution.solved) return true;
  const VectorXd sigma = solution.inverse->diagonal().cwiseMax(1e-300).cwiseSqrt();
  bool steady = solution.x.size() == 0 || solution.x.cwiseQuotient(sigma).cwiseAbs().maxCoeff() < steady_step;
  for (size_t i = 0; i < problem_->globals.size(); ++i) {
    const Parameter p = problem_->globals[i];
    set_value(state.calibration, p, value_of(state.calibration, p) + solution.x[i]);
  }
  state.correction += solution.x.tail(problem_->knots->size());
  for (size_t k = 0; k < state.planes.size(); ++k) move_plane(state.planes[k], solution.d[k]);
  if (!variances) return steady;

  const SigmaFactors old = factors;
  update_white(pass.blocks, use, options_->components, factors);
  update_correlated(*problem_, *system_, solution, tests, use, *prior, state.correction, options_->components, factors);
  scale *= old.range.factor / factors.range.factor;
  const auto look = [&](const SigmaFactor& now, const SigmaFactor& was) {
    if (std::abs(now.factor / was.factor - 1.0) > steady_factor) steady = false;
  };
  for (SigmaFactor SigmaFactors::*f : {&SigmaFactors::range, &SigmaFactors::angle, &SigmaFactors::surface, &SigmaFactors::control})
    look(factors.*f, old.*f);
  for (const size_t k : {line_mean, line_drift, within_line}) {
    look(factors.position[k], old.position[k]);
    look(factors.attitude[k], old.attitude[k]);
  }
  return steady;
}

void AdjustRounds::iterate(bool variances) {
  converged = false;
  for (int i = 0; i < options_->iterations && !converged; ++i) converged = round(variances && (i > 0 || rounds > 1));
}

bool AdjustRounds::snoop() {
  bool any = false;
  solve_here();
  for (int i = 0; i < batches && solution.solved; ++i) {
    if (reject_worst(*system_, tests, options_->snooping, use, snooping_full) == 0) break;
    any = true;
    sum_up();
  }
  return any;
}

void AdjustRounds::release_contradicted() {
  const auto n = static_cast<Eigen::Index>(problem_->globals.size());
  if (n == 0 || !solution.solved) return;
  solve_here();
  if (!solution.solved) return;
  VectorXd found(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Parameter p = problem_->globals[static_cast<size_t>(i)];
    found[i] = value_of(state.calibration, p) - value_of(start_, p);
  }
  contradiction = contradicted(found, solution.of_globals(static_cast<int>(n)).diagonal().cwiseSqrt(), apriori_);
  for (Eigen::Index i = 0; i < n; ++i)
    if (contradiction[i] > 0.0) information_[i] = free_[i];
}

void AdjustRounds::run() {
  fit_planes();
  set_roughness();
  iterate(false);
  release_contradicted();
  iterate(true);
  if (!use.control.empty() && solution.solved) {
    solve_here(Inverse::both);
    shift = control_shift(*system_, state.planes, solution, rests);
    if (!shift.shifted) {
      use.control.assign(use.control.size(), 1);
      iterate(true);
    }
  }
  if (options_->snooping.use)
    for (int i = 0; i < snooping_rounds && solution.solved && snoop(); ++i) iterate(true);
  solve_here(problem_->globals.empty() ? Inverse::covariance : Inverse::both);
}

}  // namespace swath::calib
