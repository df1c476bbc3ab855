// SPDX-License-Identifier: GPL-3.0-or-later
// The posterior is computed on a grid of offsets and slopes that is narrowed until it is finer than the blur; on the coarse grids the blur
// is widened to the grid's step, so that no peak is missed between its nodes. Means and covariances of the last grid.
// Ceres was weighed: the likelihood of pulses on either side of an edge has steps and several peaks, and its mean and spread are wanted.
#include "calib/target/edge_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace swath::calib {
namespace {

constexpr double outliers = 0.01;    // share of pulses that may say anything (chimneys, wires, multipath)
constexpr size_t fewest_pulses = 5;  // on each side of the edge
constexpr int offsets = 31, slopes = 11;
constexpr double reach_in_sigma = 5.0;  // of a narrowed grid, to either side
constexpr int most_levels = 7;
constexpr double most_mass_at_end = 0.02;

double normal(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

/// Logarithms of the outcomes' probabilities by x = (e - s) / blur.
class Likelihood {
 public:
  explicit Likelihood(double half_in_blurs) : reach_(8.0 + half_in_blurs), per_unit_((size - 2) / (2.0 * reach_)) {
    for (size_t i = 0; i < size; ++i) {
      const double x = static_cast<double>(i) / per_unit_ - reach_;
      const double on = normal(x - half_in_blurs), first_on = normal(x + half_in_blurs);
      const auto mixed = [](double p) { return std::log((1.0 - outliers) * p + outliers / 3.0); };
      table_[EdgePulse::on][i] = mixed(on);
      table_[EdgePulse::both][i] = mixed(std::max(0.0, first_on - on));
      table_[EdgePulse::off][i] = mixed(normal(-x - half_in_blurs));
      table_[EdgePulse::first_on][i] = mixed(first_on);
    }
  }
  double operator()(EdgePulse::Outcome outcome, double x) const {
    const double at = (std::clamp(x, -reach_, reach_) + reach_) * per_unit_;
    const auto i = static_cast<size_t>(at);
    const double share = at - static_cast<double>(i);
    const auto& row = table_[outcome];
    return row[i] + share * (row[i + 1] - row[i]);
  }

 private:
  static constexpr size_t size = 1026;
  double reach_, per_unit_;
  std::array<std::array<double, size>, 4> table_;
};

struct Grid {
  double offset, offset_step, slope, slope_step;  // middle and step
  double offset_at(int i) const { return offset + (i - offsets / 2) * offset_step; }
  double slope_at(int j) const { return slope + (j - slopes / 2) * slope_step; }
};

struct Posterior {
  Eigen::Vector2d mean{0, 0};
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  double at_end = 0.0;  // mass on the first and last offsets
};

Posterior integrate(const std::vector<EdgePulse>& pulses, const EdgePrior& prior, double blur, double at, const Grid& grid) {
  const Likelihood likelihood(prior.half / blur);
  std::array<double, offsets * slopes> mass;
  for (int j = 0; j < slopes; ++j)
    for (int i = 0; i < offsets; ++i) {
      const double offset = grid.offset_at(i), slope = grid.slope_at(j);
      double sum = -0.5 * slope * slope / (prior.slope * prior.slope);
      for (const EdgePulse& p : pulses)
        sum += likelihood(p.outcome, (offset + slope * (static_cast<double>(p.t) - at) - static_cast<double>(p.s)) / blur);
      mass[static_cast<size_t>(j * offsets + i)] = sum;
    }
  const double highest = *std::max_element(mass.begin(), mass.end());
  double total = 0.0;
  for (double& m : mass) total += m = std::exp(m - highest);
  Posterior out;
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  for (int j = 0; j < slopes; ++j)
    for (int i = 0; i < offsets; ++i) {
      const double m = mass[static_cast<size_t>(j * offsets + i)] / total;
      const Eigen::Vector2d v(grid.offset_at(i) - grid.offset, grid.slope_at(j) - grid.slope);
      out.mean += m * v;
      second += m * v * v.transpose();
      if (i == 0 || i == offsets - 1) out.at_end += m;
    }
  // Beside the spread between nodes: that of a node's own cell.
  const Eigen::Vector2d cell(grid.offset_step * grid.offset_step / 12.0, grid.slope_step * grid.slope_step / 12.0);
  out.covariance = second - out.mean * out.mean.transpose() + Eigen::Matrix2d(cell.asDiagonal());
  out.mean += Eigen::Vector2d(grid.offset, grid.slope);
  return out;
}

}  // namespace

SideView locate_edge(const std::vector<EdgePulse>& pulses, const EdgePrior& prior) {
  SideView view;
  view.pulses = static_cast<std::uint32_t>(pulses.size());
  size_t on = 0, off = 0;
  for (const EdgePulse& p : pulses) {
    on += p.outcome != EdgePulse::off;
    off += p.outcome == EdgePulse::off || p.outcome == EdgePulse::both;
    view.at += static_cast<double>(p.t) / static_cast<double>(pulses.size());
  }
  if (on < fewest_pulses || off < fewest_pulses) return view;

  Grid grid{0.0, 2.0 * prior.reach / (offsets - 1), 0.0, 6.0 * prior.slope / (slopes - 1)};
  Posterior found;
  for (int level = 0; level < most_levels; ++level) {
    const bool fine = grid.offset_step < 0.5 * prior.blur;
    found = integrate(pulses, prior, std::max(prior.blur, grid.offset_step), view.at, grid);
    if (level == 0 && found.at_end > most_mass_at_end) return view;
    const double offset_sigma = std::sqrt(found.covariance(0, 0)), slope_sigma = std::sqrt(found.covariance(1, 1));
    const double step = 2.0 * reach_in_sigma * offset_sigma / (offsets - 1);
    // Narrow enough where the blur was not widened and the grid spans little more than the mass.
    if (fine && step > 0.5 * grid.offset_step) break;
    grid = {found.mean[0], std::min(step, grid.offset_step), found.mean[1],
            std::min(2.0 * reach_in_sigma * slope_sigma / (slopes - 1), grid.slope_step)};
  }
  view.offset = found.mean[0];
  view.slope = found.mean[1];
  view.covariance = found.covariance;
  view.used = std::abs(view.offset) < prior.reach && std::sqrt(found.covariance(0, 0)) < prior.reach / 3.0;
  return view;
}

EdgeShape edge_shape(const std::vector<EdgePulse>& pulses, double blur, double widest) {
  constexpr std::array<double, 7> factors{0.5, 0.63, 0.79, 1.0, 1.26, 1.59, 2.0};
  constexpr double factor_sigma = 0.5;  // of the factor's logarithm
  constexpr int halves = 25;
  EdgeShape best{blur, 0.0};
  double highest = -1e300;
  for (const double f : factors)
    for (int k = 0; k < (widest > 0.0 ? halves : 1); ++k) {
      const double half = widest * k / (halves - 1);
      const Likelihood likelihood(half / (f * blur));
      double sum = -0.5 * std::log(f) * std::log(f) / (factor_sigma * factor_sigma);
      for (const EdgePulse& p : pulses) sum += likelihood(p.outcome, -static_cast<double>(p.s) / (f * blur));
      if (sum > highest) {
        highest = sum;
        best = {f * blur, half};
      }
    }
  return best;
}

}  // namespace swath::calib
