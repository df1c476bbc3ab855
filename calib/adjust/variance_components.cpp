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
#include <numeric>

namespace swath::calib {

using Eigen::MatrixXd;
using Eigen::VectorXd;

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

namespace {

/// Of all corrections at once: their covariance as given, and modes of each scale.
std::array<std::array<ScaleSums, 3>, 2> sums_of(const CorrectionKnots& knots, const TieMatrix& information, const TieSolution& s,
                                                int globals, const VectorXd& correction, const SigmaFactors& f) {
  std::array<std::array<ScaleSums, 3>, 2> out;
  std::vector<int> numbers(static_cast<size_t>(correction.size()));
  std::iota(numbers.begin(), numbers.end(), globals);
  const MatrixXd left = s.covariance(numbers), Q = information.whole().bottomRightCorner(correction.size(), correction.size());
  const VectorXd weighted = Q * correction, known = Q.cwiseProduct(left).rowwise().sum();
  std::array<ScaleSums, 2> whole;
  for (Eigen::Index i = 0; i < correction.size(); ++i) {
    ScaleSums& of = whole[knots.is_position(static_cast<int>(i)) ? 0 : 1];
    of.squares += correction[i] * weighted[i];
    of.freedom += 1.0 - known[i];
  }
  for (const size_t part : {0, 1}) out[part][within_line] = whole[part];
  if (!knots.scales_apart()) return out;
  // Means and drifts by their own prior, what is left by what it adds to both. Before the factors change.
  const MatrixXd apriori = knots.covariance(f.of_position(), f.of_attitude());
  for (const size_t part : {0, 1}) {
    const MatrixXd &mean = knots.modes(part == 0, line_mean), &drift = knots.modes(part == 0, line_drift);
    MatrixXd both(mean.rows(), mean.cols() + drift.cols());
    both << mean, drift;
    const VectorXd value = both.transpose() * correction;
    const MatrixXd C = both.transpose() * apriori * both, S = both.transpose() * left * both;
    const auto of = [&](Eigen::Index first, Eigen::Index n) -> ScaleSums {
      if (n == 0) return {};
      const auto expected = C.block(first, first, n, n).ldlt();
      return {value.segment(first, n).dot(expected.solve(value.segment(first, n))),
              static_cast<double>(n) - expected.solve(S.block(first, first, n, n)).trace()};
    };
    const ScaleSums trend = of(0, both.cols());
    out[part] = {
        of(0, mean.cols()), of(mean.cols(), drift.cols()), {whole[part].squares - trend.squares, whole[part].freedom - trend.freedom}};
  }
  return out;
}

}  // namespace

void update_correlated(const TieProblem& problem, const TieSystem& system, const TieSolution& s, const TieTests& tests,
                       const TieSelection& use, const TiePrior& prior, const VectorXd& correction, const ComponentOptions& o,
                       SigmaFactors& f) {
  const auto globals = static_cast<int>(problem.globals.size());
  update_surface(system.surface() * system.surface(), tests, use, o, f);
  const CorrectionKnots& knots = *problem.knots;
  if (correction.size() > 0) {
    const auto sums = knots.is_chained() ? knots.chains().sums({f.of_position(), f.of_attitude()}, correction, *s.inverse, globals)
                                         : sums_of(knots, prior.corrections, s, globals, correction, f);
    for (const size_t part : {0, 1}) {
      std::array<SigmaFactor, 3>& of_part = part == 0 ? f.position : f.attitude;
      const bool wanted = part == 0 ? o.position : o.attitude;
      if (knots.scales_apart()) {
        for (const CorrectionScale scale : {line_mean, line_drift, within_line})
          update_with_freedom(of_part[scale], sums[part][scale].squares, sums[part][scale].freedom, wanted, o.freedom);
        continue;
      }
      ScaleSums all;
      for (const ScaleSums& one : sums[part]) all.squares += one.squares, all.freedom += one.freedom;
      update_with_freedom(of_part[0], all.squares, all.freedom, wanted, o.freedom);
      of_part[1] = of_part[2] = of_part[0];
    }
  }
  update_control(tests, use, o, f);
}

}  // namespace swath::calib
