// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/ins_noise.h"

#include <algorithm>
#include <cmath>

namespace swath::trajectory {
namespace {

using Eigen::Vector3d;

constexpr double least_share = 0.02;
constexpr double least_fixes = 100;                  // from which noise is estimated
constexpr double too_large = 1.5, too_alike = 0.25;  // normalised innovations: mean square, correlation of neighbours
constexpr double most_roughness = 64;
constexpr double much_correlated = 0.75;  // below, sigmas cannot be twice too large: the white part is part of them
constexpr double sure_gain = 10.0;        // of the logarithm of the likelihood; right sigmas gave 3 at most
constexpr double least_gain = 1.0;        // of a halving: less is noise
constexpr int most_halvings = 6;          // of the correlated variance: an eighth of the sigma

/// Logarithm of the likelihood of the innovations of the fixes that count whole in `among`, up to a constant; axes as independent.
double log_likelihood(const Problem& problem, const std::vector<FixOutcome>& among, const std::vector<FixOutcome>& outcomes) {
  double out = 0;
  for (size_t k = 0; k < problem.nodes.size(); ++k)
    if (problem.nodes[k].fix >= 0 && among[k].weight >= 1) out -= 0.5 * outcomes[k].nis + outcomes[k].innovation_sigma.array().log().sum();
  return out;
}

}  // namespace

bool adapt_fixes(Problem& problem, const std::vector<FixOutcome>& outcomes) {
  double nis = 0, all = 0, n = 0;
  for (size_t k = 0; k < problem.nodes.size(); ++k) {
    const FixOutcome& o = outcomes[k];
    if (problem.nodes[k].fix < 0 || o.weight < 1) continue;
    const double expected = o.innovation_sigma.squaredNorm() / problem.gnss.covariance[static_cast<size_t>(problem.nodes[k].fix)].trace();
    if (expected > 4 * problem.variance) continue;  // after an outage the innovations depend on the IMU
    nis += o.nis / 3;
    all += expected;
    n += 1;
  }
  if (n < least_fixes) return false;
  const double white = (1 - problem.share) * problem.variance;  // of the stated variance
  const double shown = std::clamp(white + (nis / n - 1) * (all / n), 0.2 * white, 5 * white);
  const double noise = std::sqrt(2 / (3 * n)) * (all / n);
  // Within the stated variance the rest of it is correlated; beyond, the share rises to the usual one as the statement proves worthless.
  problem.share = shown < 1 ? std::clamp(1 - shown, least_share, largest_share)
                            : std::min(usual_share, least_share + (usual_share - least_share) * (shown - 1));
  problem.variance = std::max(1.0, shown / (1 - problem.share));
  return std::abs(shown - white) > std::max(0.03 * white, 2 * noise);
}

double overstatement(const Problem& problem, const std::function<std::vector<FixOutcome>(const Problem&)>& pass) {
  if (problem.share < much_correlated) return 1.0;
  const double white = (1 - problem.share) * problem.variance;
  const std::vector<FixOutcome> stated = pass(problem);
  const double before = log_likelihood(problem, stated, stated);
  double correlated = problem.share * problem.variance, best = before, variance = problem.variance;
  for (int k = 0; k < most_halvings; ++k) {
    correlated /= 2;
    Problem smaller = problem;
    smaller.variance = white + correlated;
    smaller.share = correlated / smaller.variance;
    const double now = log_likelihood(problem, stated, pass(smaller));
    if (now < best + least_gain) break;
    best = now;
    variance = smaller.variance;
  }
  return best - before < sure_gain ? 1.0 : std::sqrt(problem.variance / variance);
}

bool adapt_imu(Problem& problem, const std::vector<FixOutcome>& outcomes) {
  if (problem.noise.angle == 0 && problem.noise.velocity == 0) return false;  // stated as perfect
  double alike = 0, squares = 0, n = 0;
  Vector3d before = Vector3d::Zero();
  for (size_t k = 0; k < problem.nodes.size(); ++k) {
    if (problem.nodes[k].fix < 0) continue;
    const Vector3d z = outcomes[k].innovation.cwiseQuotient(outcomes[k].innovation_sigma);
    alike += z.dot(before);
    squares += z.squaredNorm();
    before = z;
    n += 1;
  }
  if (n < least_fixes || squares / (3 * n) < too_large || alike / squares < too_alike || problem.roughness >= most_roughness) return false;
  problem.roughness *= 2;
  for (double* density : {&problem.noise.angle, &problem.noise.velocity, &problem.noise.gyro_drift, &problem.noise.force_drift})
    *density *= 4;
  return true;
}

}  // namespace swath::trajectory
