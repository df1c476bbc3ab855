// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Foerstner, "Ein Verfahren zur Schaetzung von Varianz- und Kovarianzkomponenten" (1979): variance = v^T P v / redundancy of the
// component, repeated until steady. For ranges and angles, which share every condition, the pair of equations (Helmert's estimator) is
// solved at once. Deviation: the trajectory's and the control's factors carry stated degrees of freedom, for a few lines would determine
// them badly: with r degrees of freedom the estimated factor itself has the relative sigma 1 / sqrt(2 r). Where the prior's correlation in
// time is a guess, the mean of a line, its drift and what is left within it have factors of their own: one for all would follow the many
// corrections within the lines and be untrue for the few means.
#include "calib/adjust/variance_components.h"

#include <algorithm>
#include <cmath>

namespace swath::calib {
namespace {

constexpr double taken_sigma = 0.25;   // relative sigma of a variance that is taken
constexpr double least_freedom = 3.0;  // degrees of freedom
constexpr double lowest = 0.1, highest = 20.0;
constexpr double step = 2.0;  // of a sigma, in one round
// Groups far out do not make the others' sigma: they are left to the snooping.
constexpr double largest_square = 9.0;

double bounded(double variance_ratio) { return std::clamp(std::sqrt(std::max(0.0, variance_ratio)), 1.0 / step, step); }
void apply(SigmaFactor& f, double variance_ratio) { f.factor = std::clamp(f.factor * bounded(variance_ratio), lowest, highest); }

}  // namespace

void update_white(const std::vector<GroupBlock>& blocks, const TieSelection& use, const ComponentOptions& o, SigmaFactors& f) {
  double m[5] = {};
  for (size_t g = 0; g < blocks.size(); ++g)
    if (use.group[g])
      for (int k = 0; k < 5; ++k) m[k] += blocks[g].moment[k];
  f.range.estimated = f.angle.estimated = false;
  f.range.redundancy = m[0];
  f.angle.redundancy = 0.0;
  // Variance of normally distributed squares is twice their mean's: the estimates have the covariance 2 M^-1.
  const double det = m[0] * m[2] - m[1] * m[1];
  const auto is_taken = [](double variance) { return variance > 0.0 && 2.0 * variance < taken_sigma * taken_sigma; };
  if (det > 1e-12 * m[0] * m[2] && m[2] > 0.0) f.angle.redundancy = det / m[0];
  if (o.range && o.angle && f.angle.redundancy > 0.0 && is_taken(m[2] / det) && is_taken(m[0] / det)) {
    apply(f.range, (m[2] * m[3] - m[1] * m[4]) / det);
    apply(f.angle, (m[0] * m[4] - m[1] * m[3]) / det);
    f.range.estimated = f.angle.estimated = true;
    f.range.redundancy = det / m[2];
  } else if (o.range && m[0] > 0.0 && is_taken(1.0 / m[0])) {
    apply(f.range, (m[3] - m[1]) / m[0]);
    f.range.estimated = true;
  } else if (o.angle && !o.range && m[2] > 0.0 && is_taken(1.0 / m[2])) {
    apply(f.angle, (m[4] - m[1]) / m[2]);
    f.angle.estimated = true;
  }
}

namespace {

void update_with_freedom(SigmaFactor& factor, double omega, double redundancy, bool wanted, double freedom) {
  factor.redundancy = redundancy;
  factor.estimated = wanted && redundancy >= least_freedom;
  if (!factor.estimated) return;
  const double now = factor.factor * factor.factor;
  apply(factor, (freedom + now * std::max(0.0, omega)) / (freedom + redundancy) / now);
}

void update_surface(double t2, const TieTests& tests, const TieSelection& use, const ComponentOptions& o, SigmaFactors& f) {
  double surface = 0.0, surface_freedom = 0.0;
  for (size_t g = 0; g < tests.group.size(); ++g) {
    if (!use.group[g]) continue;
    const TieTest& t = tests.group[g];
    surface += std::min(t.w * t.w, largest_square) * t2 * t.information;
    surface_freedom += t2 * t.information;
  }
  f.surface.redundancy = surface_freedom;
  f.surface.estimated = o.surface && surface_freedom >= least_freedom;
  if (f.surface.estimated) apply(f.surface, surface / surface_freedom);
}

void update_control(const TieTests& tests, const TieSelection& use, const ComponentOptions& o, SigmaFactors& f) {
  double control = 0.0, control_freedom = 0.0;
  for (size_t c = 0; c < tests.control.size(); ++c) {
    if (!use.control[c]) continue;
    control += tests.control[c].w * tests.control[c].w * tests.control[c].redundancy;
    control_freedom += tests.control[c].redundancy;
  }
  update_with_freedom(f.control, control, control_freedom, o.control, o.freedom);
}

}  // namespace

void update_correlated(const TieProblem& problem, const TieSystem& system, const TieSolution& s, const TieTests& tests,
                       const TieSelection& use, const TiePrior& prior, const Eigen::VectorXd& correction, const ComponentOptions& o,
                       SigmaFactors& f) {
  const auto globals = static_cast<Eigen::Index>(problem.globals.size());
  const auto with_freedom = [&](SigmaFactor& factor, double omega, double redundancy, bool wanted) {
    update_with_freedom(factor, omega, redundancy, wanted, o.freedom);
  };
  update_surface(system.surface() * system.surface(), tests, use, o, f);

  double omega[2] = {}, freedom[2] = {};
  const CorrectionKnots& knots = *problem.knots;
  const Eigen::VectorXd weighted = prior.corrections * correction;
  for (Eigen::Index i = 0; i < correction.size(); ++i) {
    const int part = knots.is_position(static_cast<int>(i)) ? 0 : 1;
    omega[part] += correction[i] * weighted[i];
    freedom[part] += 1.0 - prior.corrections.col(i).dot(s.covariance.col(globals + i).tail(correction.size()));
  }
  // Before the factors change.
  const Eigen::MatrixXd apriori = knots.scales_apart() ? knots.covariance(f.of_position(), f.of_attitude()) : Eigen::MatrixXd();
  const auto left = s.covariance.bottomRightCorner(correction.size(), correction.size());
  for (const int part : {0, 1}) {
    std::array<SigmaFactor, 3>& of_part = part == 0 ? f.position : f.attitude;
    const bool wanted = part == 0 ? o.position : o.attitude;
    if (!knots.scales_apart()) {
      with_freedom(of_part[0], omega[part], freedom[part], wanted);
      of_part[1] = of_part[2] = of_part[0];
      continue;
    }
    // Means and drifts by their own prior, what is left by what it adds to both.
    const Eigen::MatrixXd &mean = knots.modes(part == 0, line_mean), &drift = knots.modes(part == 0, line_drift);
    Eigen::MatrixXd both(mean.rows(), mean.cols() + drift.cols());
    both << mean, drift;
    const Eigen::VectorXd value = both.transpose() * correction;
    const Eigen::MatrixXd C = both.transpose() * apriori * both, S = both.transpose() * left * both;
    const auto tell = [&](Eigen::Index first, Eigen::Index n) {
      if (n == 0) return std::pair(0.0, 0.0);
      const auto expected = C.block(first, first, n, n).ldlt();
      return std::pair(value.segment(first, n).dot(expected.solve(value.segment(first, n))),
                       static_cast<double>(n) - expected.solve(S.block(first, first, n, n)).trace());
    };
    const auto [omega_mean, freedom_mean] = tell(0, mean.cols());
    const auto [omega_drift, freedom_drift] = tell(mean.cols(), drift.cols());
    const auto [omega_both, freedom_both] = tell(0, both.cols());
    with_freedom(of_part[line_mean], omega_mean, freedom_mean, wanted);
    with_freedom(of_part[line_drift], omega_drift, freedom_drift, wanted);
    with_freedom(of_part[within_line], omega[part] - omega_both, freedom[part] - freedom_both, wanted);
  }
  update_control(tests, use, o, f);
}

}  // namespace swath::calib
