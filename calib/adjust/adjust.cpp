// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: Skaloud & Lichti (2006) and Glira et al. (2016) for the model (calib/adjust/tie_normals.h, correction_knots.h); Foerstner (1979)
// for the variances; Baarda (1968) for the tests; Schmidt (1966) for values that are held and yet uncertain ("considered"). Here: the
// unknowns are chosen, the rounds are run, and the results are put together. Deviations: sigmas take the estimated variances as known
// (their own scatter adds a per cent or so to 20 degrees of freedom's 16 % in a component that is one of several); refused values are
// delivered as they started while the others come from the joint solution.
#include "calib/adjust/adjust.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "calib/adjust/adjust_findings.h"
#include "calib/adjust/adjust_results.h"
#include "calib/adjust/diagnosis.h"
#include "calib/adjust/jackknife.h"
#include "calib/adjust/start_sigmas.h"

namespace swath::calib {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double common_shift = 1.0;           // m: how wrong all positions may be together, for Separation::unaided
constexpr double smallest_eigenvalue = 1e-15;  // of a matrix scaled to ones on its diagonal
constexpr int least_jackknifed = 4;            // lines: without one of two or three the others' geometry is another flight's

std::vector<Parameter> chosen(const EstimateOptions& o, const core::Scanner& scanner, std::vector<Finding>& findings) {
  const BeamModel beam(scanner);
  const bool wanted[] = {o.roll,         o.pitch,       o.heading,     o.lever_forward, o.lever_right, o.lever_down,
                         o.range_offset, o.range_scale, o.scan_offset, o.scan_scale,    o.latency};
  std::vector<Parameter> out;
  for (int k = boresight_roll; k <= latency; ++k) {
    const auto p = static_cast<Parameter>(k);
    if (!wanted[k]) continue;
    if (p == scan_offset && o.roll && beam.is_across()) {
      findings.push_back({"scan offset and boresight roll are the same turn of a scanner that scans across: the scan offset is held",
                          "estimate one of the two",
                          {scan_offset},
                          true});
      continue;
    }
    if (p == scan_offset && o.heading && scanner.model == core::ScannerModel::conical) {
      findings.push_back(
          {"scan offset and boresight heading are the same turn of a scanner whose beam goes around the nadir: the scan offset is held",
           "estimate one of the two",
           {scan_offset},
           true});
      continue;
    }
    if (p == scan_scale && beam.ignores_record()) continue;
    out.push_back(p);
  }
  return out;
}

MatrixXd scaled_inverse(const MatrixXd& N) {
  if (N.rows() == 0) return N;
  const VectorXd scale = N.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scale.asDiagonal() * N * scale.asDiagonal());
  const VectorXd values = eigen.eigenvalues().cwiseMax(smallest_eigenvalue).cwiseInverse();
  return scale.asDiagonal() * eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose() * scale.asDiagonal();
}

VectorXd sigmas_with(const MatrixXd& information, const VectorXd& prior) {
  MatrixXd N = information;
  N.diagonal() += prior;
  return scaled_inverse(N).diagonal().cwiseMax(0.0).cwiseSqrt();
}

// What the data alone show of the global unknowns, and what they would show if all positions could be shifted together.
Separation separate(const TieProblem& p, const AdjustRounds& r) {
  Separation out;
  const auto globals = static_cast<Eigen::Index>(p.globals.size());
  const MatrixXd of_globals = r.solution.of_globals(static_cast<int>(globals));
  out.information = scaled_inverse(of_globals);
  out.information.diagonal() -= r.prior->globals;
  out.formal = of_globals.diagonal().cwiseSqrt();
  const MatrixXd B = p.knots->common_shift();
  if (globals == 0 || B.size() == 0 || B.isZero()) return out;
  // The corrections' information Q becomes Q - Q B (B^T Q B + 1 / s^2)^-1 B^T Q, and the inverse what the matrix inversion lemma says.
  MatrixXd QB(p.size(), 3);
  for (Eigen::Index k = 0; k < 3; ++k) {
    VectorXd shift = VectorXd::Zero(p.size());
    shift.tail(B.rows()) = B.col(k);
    QB.col(k) = r.prior->corrections.times(shift);
  }
  const MatrixXd inner = B.transpose() * QB.bottomRows(B.rows()) + MatrixXd::Identity(3, 3) / (common_shift * common_shift);
  const MatrixXd moved = r.solution.inverse->solve(QB);
  const MatrixXd more = inner - QB.transpose() * moved;
  out.unaided = (of_globals + moved.topRows(globals) * more.ldlt().solve(moved.topRows(globals).transpose()))
                    .diagonal()
                    .cwiseMax(of_globals.diagonal())
                    .cwiseSqrt();
  return out;
}

/// If every return were independent and the trajectory without error.
VectorXd white_sigmas(const TieProblem& p, const AdjustRounds& r) {
  const auto globals = static_cast<Eigen::Index>(p.globals.size());
  if (globals == 0) return {};
  Normals n(static_cast<int>(globals));
  for (std::uint32_t k = 0; k < r.system().planes(); ++k) r.system().add(k, r.use, 1.0, n, true);
  return sigmas_with(n.N.whole(), r.prior->globals);
}

void put_estimates(const TieProblem& p, const AdjustRounds& r, const Separation& separation, const HeldEffects& effects,
                   const VectorXd& apriori, const JackknifeOptions& o, Adjustment& out) {
  const auto globals = static_cast<Eigen::Index>(p.globals.size());
  const VectorXd white = white_sigmas(p, r);
  std::vector<int> numbers(p.globals.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  const MatrixXd held = effects.covariance(numbers);
  const double significance = o.significance;
  Jackknife lines, regions;
  if (globals > 0 && o.lines) lines = jackknife(p, r.system(), r.use, *r.normals, r.solution, groups_by_line(*p.ties, r.use));
  if (globals > 0 && o.blocks > 1)
    regions = jackknife(p, r.system(), r.use, *r.normals, r.solution, groups_by_region(*p.ties, r.use, o.blocks));
  for (Eigen::Index i = 0; i < globals; ++i) {
    Estimate& e = out.estimates[p.globals[i]];
    e.estimated = true;
    e.found = value_of(r.state.calibration, e.parameter);
    e.apriori = apriori[i];
    e.formal = separation.formal[i];
    e.white = white[i];
    double larger = 1.0;
    if (lines.replicates > 0) {
      e.jackknife_lines = lines.sigma[i];
      if (lines.replicates >= least_jackknifed) larger = std::max(larger, enlargement(lines.ratio[i], lines.freedom[i], significance));
    }
    if (regions.replicates > 0) {
      e.jackknife_planes = regions.sigma[i];
      larger = std::max(larger, enlargement(regions.ratio[i], regions.freedom[i], significance));
    }
    e.held = std::sqrt(std::max(0.0, held(i, i)));
    const double own = lines.replicates >= least_jackknifed ? std::max(larger * e.formal, e.jackknife_lines) : larger * e.formal;
    e.sigma = e.found_sigma = std::hypot(own, e.held);
    e.determined = std::isfinite(e.apriori) ? 1.0 - std::pow(e.formal / e.apriori, 2) : 1.0;
  }
  const MatrixXd C = r.solution.covariance(numbers) + held;
  const VectorXd inverse = C.diagonal().cwiseSqrt().cwiseInverse();
  out.correlation = inverse.asDiagonal() * C * inverse.asDiagonal();
  out.correlation.diagonal().setOnes();
  out.condition = scaled_condition(separation.information);
}

void keep_covariance(const TieProblem& problem, const AdjustRounds& r, const HeldEffects& held, Adjustment& out) {
  const std::vector<Parameter>& globals = problem.globals;
  constexpr int n = latency + 1;
  out.formal = out.held = MatrixXd::Zero(n, n);
  out.held_correlation = MatrixXd::Identity(n, n);
  const MatrixXd formal = r.solution.of_globals(static_cast<int>(globals.size()));
  for (size_t i = 0; i < globals.size(); ++i)
    for (size_t j = 0; j < globals.size(); ++j)
      out.formal(globals[i], globals[j]) = formal(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  for (size_t h = 0; h < held.parameters.size(); ++h) {
    const auto column = static_cast<Eigen::Index>(h);
    const Parameter p = held.parameters[h];
    out.held(p, p) = held.sigma[column];
    for (size_t i = 0; i < globals.size(); ++i) out.held(globals[i], p) = held.effect(static_cast<Eigen::Index>(i), column);
    for (size_t k = 0; k < held.parameters.size(); ++k)
      out.held_correlation(p, held.parameters[k]) = held.correlation(column, static_cast<Eigen::Index>(k));
  }
}

/// What the flight does not determine, and what is hardly separated.
void put_diagnosis(const TieProblem& p, const AdjustRounds& r, Separation judged, const VectorXd& apriori, const LimitOptions& limits,
                   Adjustment& out) {
  // The limits are held against the sigma that would be delivered.
  for (size_t i = 0; i < p.globals.size(); ++i) judged.formal[static_cast<Eigen::Index>(i)] = out.estimates[p.globals[i]].sigma;
  FlightShape shape = shape_of(p, r.state, r.pass.blocks);
  shape.control = std::find(r.use.control.begin(), r.use.control.end(), char{1}) != r.use.control.end();
  std::vector<Parameter> refused;
  for (Finding& f : diagnose(p.globals, judged, apriori, shape, limits)) {
    if (f.refuses) refused.insert(refused.end(), f.parameters.begin(), f.parameters.end());
    out.findings.push_back(std::move(f));
  }
  find_correlated(p.globals, refused, shape, out);
}

}  // namespace

Adjustment adjust(const TieSet& ties, const core::Scanner& scanner, const core::Calibration& start, const core::SensorSigma& noise,
                  const trajectory::Trajectory& trajectory, const ErrorCovariance& covariance, const AdjustOptions& options, int threads,
                  ErrorShape shape) {
  Adjustment out;
  out.calibration = start;
  for (int k = boresight_roll; k <= latency; ++k) {
    Estimate& e = out.estimates[k];
    e.parameter = static_cast<Parameter>(k);
    e.start = e.value = e.found = value_of(start, e.parameter);
  }
  const bool is_stated = options.corrections.prior == CorrectionPrior::stated;
  const CorrectionKnots knots(ties.lines, start.latency.value, options.corrections,
                              is_stated ? stated_covariance(options.corrections) : covariance, is_stated || shape == ErrorShape::guessed);
  out.knot_spacing = knots.spacing();
  TieProblem problem{&ties, &scanner, &trajectory, &knots, {}, RobustWeight(options.robust.full, options.robust.zero), threads};
  problem.globals = chosen(options.estimate, scanner, out.findings);
  VectorXd apriori(problem.globals.size()), limit(problem.globals.size());
  for (size_t i = 0; i < problem.globals.size(); ++i) {
    apriori[i] = apriori_of(options.apriori, problem.globals[i]);
    limit[i] = limit_of(options.limits, problem.globals[i]);
  }

  AdjustRounds rounds(problem, start, noise, apriori, limit, options);
  rounds.run();
  if (!rounds.solution.solved) {
    out.planes = ties.planes;
    out.findings.push_back(
        {"the normal equations cannot be solved", "check that trajectory and returns are of one flight", problem.globals, true});
    return out;
  }
  find_contradicted_starts(problem, rounds, apriori, out.findings);
  const HeldEffects held = effects_of_held(problem, rounds, noise);
  const Separation separation = separate(problem, rounds);
  put_results(problem, rounds, noise, options, held, out);
  put_estimates(problem, rounds, separation, held, apriori, options.jackknife, out);
  keep_covariance(problem, rounds, held, out);
  put_diagnosis(problem, rounds, separation, apriori, options.limits, out);
  find_wide_knots(options.corrections, knots.spacing(), knots.corrections(), out);
  find_contradictions(problem, rounds, out);

  for (size_t i = 0; i < problem.globals.size(); ++i) {
    const Parameter p = problem.globals[i];
    Estimate& e = out.estimates[p];
    e.delivered = true;
    e.grade = e.sigma <= limit[static_cast<Eigen::Index>(i)] ? Grade::good : Grade::coarse;
    e.value = e.found;
    set_value(out.calibration, p, e.value);
  }
  for (const Finding& f : out.findings)
    if (f.refuses) withdraw(out, f.parameters, out.last_step > settled_step ? Grade::unsettled : Grade::undetermined);
  return out;
}

}  // namespace swath::calib
