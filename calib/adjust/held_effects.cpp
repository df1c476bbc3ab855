// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Schmidt (1966), values that are considered without being estimated: the solution is repeated with each of them one sigma larger.
#include "calib/adjust/held_effects.h"

#include <algorithm>
#include <cmath>

namespace swath::calib {

double correlation_of(const core::SensorSigma& sensor, Parameter a, Parameter b) {
  constexpr size_t n = latency + 1;
  if (a == b) return 1.0;
  return sensor.correlation.size() == n * n ? sensor.correlation[static_cast<size_t>(a) * n + static_cast<size_t>(b)] : 0.0;
}

Eigen::MatrixXd HeldEffects::covariance(const std::vector<int>& unknowns) const {
  const Eigen::MatrixXd rows = effect(unknowns, Eigen::all);
  return rows * correlation * rows.transpose();
}

HeldEffects effects_of_held(const TieProblem& problem, const AdjustRounds& r, const core::SensorSigma& sensor) {
  const Variances stated = variances(sensor, {});
  const auto is_unknown = [&](Parameter p) {
    return std::find(problem.globals.begin(), problem.globals.end(), p) != problem.globals.end();
  };
  const Parameter same = problem.scanner->model == core::ScannerModel::conical ? boresight_heading : boresight_roll;
  HeldEffects out;
  std::vector<Eigen::VectorXd> columns;
  for (int k = boresight_roll; problem.size() > 0 && k <= latency; ++k) {
    const auto p = static_cast<Parameter>(k);
    if (is_unknown(p) || !(stated[p] > 0.0) || (p == scan_offset && is_unknown(same))) continue;
    TieState other = r.state;
    set_value(other.calibration, p, value_of(other.calibration, p) + std::sqrt(stated[p]));
    const TiePass pass = linearise(problem, other, r.noise(), r.scale);
    const TieSystem system(problem, pass.blocks, r.system().control(), r.surface());
    std::vector<PlaneRest> rests;
    Normals n = system.sum(r.use, rests);
    add_prior(*r.prior, n);
    const TieSolution moved = solve(system, n, rests, Inverse::factor);
    if (!moved.solved) continue;
    columns.push_back(moved.x - r.solution.x);
    out.parameters.push_back(p);
  }
  const auto n = static_cast<Eigen::Index>(columns.size());
  out.effect = Eigen::MatrixXd::Zero(problem.size(), n);
  out.sigma.resize(n);
  out.correlation = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    out.effect.col(k) = columns[static_cast<size_t>(k)];
    out.sigma[k] = std::sqrt(stated[out.parameters[static_cast<size_t>(k)]]);
    for (Eigen::Index j = 0; j < k; ++j)
      out.correlation(k, j) = out.correlation(j, k) =
          correlation_of(sensor, out.parameters[static_cast<size_t>(k)], out.parameters[static_cast<size_t>(j)]);
  }
  return out;
}

}  // namespace swath::calib
