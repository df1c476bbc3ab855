// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Tukey's jackknife (Efron & Tibshirani 1993, 11). Deviation: the classical sigma is read against
// its own expectation. Lines weigh unequally and come in correlated pairs, so that sqrt((J - 1) / J sum (x_j - x)^2) is no sigma of x:
// under the model var(x_j - x) = var(x_j) - var(x) (least squares), and only its ratio to the sum of these says whether the covariances are
// true.
#include "calib/adjust/jackknife.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/distributions.h"

namespace swath::calib {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Jackknife jackknife(const TieProblem& problem, const TieSystem& system, const TieSelection& use, const Normals& full,
                    const TieSolution& solution, const std::vector<std::vector<size_t>>& out) {
  const auto globals = static_cast<Eigen::Index>(problem.globals.size());
  Jackknife j;
  j.sigma = j.ratio = j.freedom = VectorXd::Zero(globals);
  VectorXd squares = VectorXd::Zero(globals), expected = squares, expected_squares = squares;
  const VectorXd variance = solution.of_globals(system.globals()).diagonal();
  for (const std::vector<size_t>& gone : out) {
    if (gone.empty()) continue;
    TieSelection without = use;
    std::set<std::uint32_t> planes;
    for (const size_t g : gone) {
      without.group[g] = 0;
      planes.insert(problem.ties->groups[g].plane);
    }
    Normals n = full;
    for (const std::uint32_t k : planes) {
      system.add(k, use, -1.0, n);
      system.add(k, without, 1.0, n);
    }
    const TieInverse inverse(n.N);
    MatrixXd right(n.b.size(), globals + 1);
    right.leftCols(globals).setIdentity();
    right.col(globals) = n.b;
    const MatrixXd left = inverse.solve(right);
    if (!left.allFinite()) continue;
    ++j.replicates;
    for (Eigen::Index i = 0; i < globals; ++i) {
      const double d = -left(i, globals) - solution.x[i];
      const double v = std::max(0.0, left(i, i) - variance[i]);
      squares[i] += d * d;
      expected[i] += v;
      expected_squares[i] += v * v;
    }
  }
  if (j.replicates < 2) {
    j.replicates = 0;
    return j;
  }
  const double share = (j.replicates - 1.0) / j.replicates;
  for (Eigen::Index i = 0; i < globals; ++i) {
    j.sigma[i] = std::sqrt(share * squares[i]);
    if (!(expected[i] > 0.0)) continue;
    j.ratio[i] = std::sqrt(squares[i] / expected[i]);
    j.freedom[i] = std::min(j.replicates - 1.0, expected[i] * expected[i] / expected_squares[i]);
  }
  return j;
}

std::vector<std::vector<size_t>> groups_by_line(const TieSet& ties, const TieSelection& use) {
  std::vector<std::vector<size_t>> out(ties.lines.size());
  for (size_t g = 0; g < ties.groups.size(); ++g)
    if (use.group[g]) out[ties.groups[g].line].push_back(g);
  return out;
}

std::vector<std::vector<size_t>> groups_by_region(const TieSet& ties, const TieSelection& use, int count) {
  std::vector<std::vector<size_t>> regions(1);  // numbers of planes
  for (size_t k = 0; k < ties.planes.size(); ++k) regions[0].push_back(k);
  while (static_cast<int>(regions.size()) < count) {
    const auto largest = std::max_element(regions.begin(), regions.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
    if (largest->size() < 2) break;
    std::vector<size_t> planes = *largest;
    Eigen::Vector2d low = ties.planes[planes[0]].centre.head<2>(), high = low;
    for (const size_t k : planes) {
      low = low.cwiseMin(ties.planes[k].centre.head<2>());
      high = high.cwiseMax(ties.planes[k].centre.head<2>());
    }
    const int axis = high.x() - low.x() >= high.y() - low.y() ? 0 : 1;
    std::stable_sort(planes.begin(), planes.end(),
                     [&](size_t a, size_t b) { return ties.planes[a].centre[axis] < ties.planes[b].centre[axis]; });
    const auto middle = planes.begin() + static_cast<std::ptrdiff_t>(planes.size() / 2);
    *largest = std::vector<size_t>(planes.begin(), middle);
    regions.emplace_back(middle, planes.end());
  }
  std::vector<size_t> region_of(ties.planes.size());
  for (size_t r = 0; r < regions.size(); ++r)
    for (const size_t k : regions[r]) region_of[k] = r;
  std::vector<std::vector<size_t>> out(regions.size());
  for (size_t g = 0; g < ties.groups.size(); ++g)
    if (use.group[g]) out[region_of[ties.groups[g].plane]].push_back(g);
  return out;
}

double enlargement(double ratio, double freedom, double significance) {
  if (!(freedom > 0.0)) return 1.0;
  const double f = std::max(1.0, freedom);
  return std::max(1.0, ratio / std::sqrt(core::chi_square_quantile(1.0 - significance, f) / f));
}

}  // namespace swath::calib
