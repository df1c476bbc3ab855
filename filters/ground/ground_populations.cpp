// SPDX-License-Identifier: GPL-3.0-or-later
// A robust surface through a low crop that stops most pulses lies between soil and crop, and the returns about it are two populations. The
// ground is then the lower one, in place of the normal distribution about the surface (the "empirical null" of Efron 2004, J. Am. Stat.
// Assoc. 99). Two normal distributions and a uniform one are fitted by expectation and maximisation (Dempster, Laird & Rubin 1977, J. R.
// Stat. Soc. B 39) to the heights under a Gaussian around each cell, and believed where they are much likelier than a single one and lie
// well apart: farther than strips that do not fit.
#include "filters/ground/ground_populations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "filters/bins.h"
#include "filters/ground/moving_planes.h"

namespace swath::filters {
namespace {

constexpr double cell = 2.0;   // m
constexpr double sigma = 1.5;  // cells: fields are much wider, and their edges must not look like two populations
constexpr int classes = 60;
constexpr double lowest = -0.405, width = 0.015;  // m
constexpr double core_of_ground = 0.3;            // m from the surface, where both populations lie at first
constexpr double fewest = 20.0;                   // returns under the kernel
constexpr int rounds = 40;
constexpr double narrowest = 0.01;     // m: below what ranges are recorded to
constexpr double rough = 0.8;          // of the noise: spread of the ground from which a place is looked at
constexpr double likelier = 6.0;       // natural logarithm
constexpr double apart = 1.8;          // of both spreads together
constexpr double beyond_noise = 2.0;   // of the noise, between the two
constexpr double least_ground = 0.05;  // share of the lower one
constexpr double deepest = 0.2;        // m under the surface: what lies deeper under one that so many draw up is a step of the ground

constexpr double by_strips = 0.4;     // of the gap, between the means of two strips: it is the strips that differ
constexpr double strip_fewest = 5.0;  // returns of a strip under the kernel
constexpr double unit = 1e-4;         // m: sums are whole numbers, so that their order does not matter

using Histogram = std::array<double, classes>;

double middle(int k) { return lowest + width * (k + 0.5); }

/// Returns of one strip near the surface in one cell.
struct OfStrip {
  size_t cell;
  std::uint16_t strip;
  std::int64_t sum, count;  ///< of heights, in units
};

/// For the cells of `wanted`, ascending.
std::vector<OfStrip> by_strip(const core::Block& b, const core::Lattice& l, const std::vector<ReturnOverGround>& returns,
                              const std::vector<char>& wanted) {
  std::vector<OfStrip> all;
  for (size_t p = 0; p < b.strip.size(); ++p) {
    if (!(std::abs(returns[p].above) < static_cast<float>(core_of_ground))) continue;
    const CellIndex at = cell_of(l, b, p);
    if (at.i < 0 || at.j < 0 || at.i >= l.nx || at.j >= l.ny || !wanted[l.at(at.i, at.j)]) continue;
    all.push_back({l.at(at.i, at.j), b.strip[p], std::lround(returns[p].above / unit), 1});
  }
  std::sort(all.begin(), all.end(),
            [](const OfStrip& x, const OfStrip& y) { return std::tie(x.cell, x.strip) < std::tie(y.cell, y.strip); });
  size_t kept = 0;
  for (const OfStrip& s : all) {
    if (kept > 0 && all[kept - 1].cell == s.cell && all[kept - 1].strip == s.strip)
      all[kept - 1].sum += s.sum, ++all[kept - 1].count;
    else
      all[kept++] = s;
  }
  all.resize(kept);
  return all;
}

struct Normal {
  double share = 0.0, mean = 0.0, spread = 1.0;
};

/// Share of the normal distribution's returns in each class.
Histogram densities(const Normal& n) {
  constexpr double negligible = 1e-12;
  Histogram d{};
  if (n.share <= 0.0) return d;
  const auto at = [&](int k) { return (middle(k) - n.mean) / n.spread; };
  const double step = width / n.spread, ratio = std::exp(-step * step);
  const int start = std::clamp(static_cast<int>(std::floor((n.mean - lowest) / width)), 0, classes - 1);
  const double peak = n.share * width * 0.3989422804014327 / n.spread * std::exp(-0.5 * at(start) * at(start));
  // exp(-t^2 / 2) from class to class by products.
  for (const int way : {1, -1}) {
    double value = peak, factor = std::exp(-way * step * at(start) - 0.5 * step * step);
    for (int k = start; k >= 0 && k < classes && value > negligible; k += way) {
      d[static_cast<size_t>(k)] = value;
      value *= factor;
      factor *= ratio;
    }
  }
  return d;
}

struct Mixture {
  std::array<Normal, 2> part;
  double elsewhere = 0.1;
  double log_likelihood = 0.0;
};

/// Moments about the lowest class's edge.
struct Moments {
  double n = 0.0, first = 0.0, second = 0.0;
  void add(double w, double x) { n += w, first += w * x, second += w * x * x; }
};

Mixture fitted(const Histogram& h, double total, Mixture m) {
  for (int round = 0;; ++round) {
    const Histogram lower = densities(m.part[0]), upper = densities(m.part[1]);
    std::array<Moments, 2> moments;
    double other = 0.0;
    m.log_likelihood = 0.0;
    for (int k = 0; k < classes; ++k) {
      const auto at = static_cast<size_t>(k);
      if (h[at] <= 0.0) continue;
      const double uniform = m.elsewhere / classes, sum = lower[at] + upper[at] + uniform, w = h[at] / sum;
      moments[0].add(w * lower[at], middle(k));
      moments[1].add(w * upper[at], middle(k));
      other += w * uniform;
      if (round == rounds) m.log_likelihood += h[at] * std::log(sum);
    }
    if (round == rounds) return m;
    for (size_t i = 0; i < 2; ++i) {
      const Moments& s = moments[i];
      if (s.n < 1e-6) {
        m.part[i].share = 0.0;
        continue;
      }
      const double mean = s.first / s.n;
      m.part[i] = {s.n / total, mean, std::sqrt(std::max(narrowest * narrowest, s.second / s.n - mean * mean))};
    }
    m.elsewhere = std::max(1e-6, other / total);
  }
}

struct TwoPopulations {
  Normal lower;
  double gap = 0.0;  ///< m; 0 where there is one
};
TwoPopulations populations_of(const Histogram& h, double noise) {
  double total = 0.0;
  Moments core;
  for (int k = 0; k < classes; ++k) {
    total += h[static_cast<size_t>(k)];
    if (std::abs(middle(k)) < core_of_ground) core.add(h[static_cast<size_t>(k)], middle(k));
  }
  if (core.n < fewest) return {};
  const auto quantile = [&](double part) {
    double sum = 0.0;
    for (int k = 0; k < classes; ++k) {
      if (std::abs(middle(k)) < core_of_ground) sum += h[static_cast<size_t>(k)];
      if (sum >= part * core.n) return middle(k);
    }
    return 0.0;
  };
  const double about_surface = std::clamp(std::sqrt(core.second / core.n), narrowest, 0.05);
  const Mixture two = fitted(h, total, {{Normal{0.5, quantile(0.15), 0.02}, Normal{0.4, quantile(0.8), 0.04}}});
  const Normal& lower = two.part[0];
  const Normal& upper = two.part[1];
  const double gap = upper.mean - lower.mean;
  const bool apart_enough = gap > apart * std::hypot(lower.spread, upper.spread) && gap > beyond_noise * noise &&
                            lower.share > least_ground && upper.share > 0.0 && lower.mean < 0.0 && lower.mean > -deepest;
  if (!apart_enough) return {};
  const Mixture one = fitted(h, total, {{Normal{0.9, 0.0, about_surface}, Normal{}}});
  return two.log_likelihood - one.log_likelihood > likelier ? TwoPopulations{lower, gap} : TwoPopulations{};
}

/// Of distances from -border to border.
std::vector<double> gaussian(int border) {
  std::vector<double> weight;
  for (int d = -border; d <= border; ++d) weight.push_back(std::exp(-0.5 * d * d / (sigma * sigma)));
  return weight;
}

using Counts = std::vector<std::array<std::uint16_t, classes>>;

/// Histograms under the Gaussian, asked for row after row: first summed along the rows, then across.
class Histograms {
 public:
  Histograms(const core::Lattice& l, const Counts& counts, const std::vector<double>& weight)
      : l_(l),
        counts_(counts),
        weight_(weight),
        border_(static_cast<int>(weight.size()) / 2),
        along_(weight.size() * static_cast<size_t>(l.nx)),
        done_(along_.size(), -1) {}

  Histogram at(int i, int j) {
    Histogram h{};
    for (int d = -border_; d <= border_; ++d) {
      const Histogram& row = along(i, j + d);
      const double w = weight_[static_cast<size_t>(d + border_)];
      for (size_t k = 0; k < classes; ++k) h[k] += w * row[k];
    }
    return h;
  }

 private:
  const Histogram& along(int i, int j) {
    const size_t at = static_cast<size_t>(j % static_cast<int>(weight_.size())) * static_cast<size_t>(l_.nx) + static_cast<size_t>(i);
    Histogram& h = along_[at];
    if (done_[at] == j) return h;
    h = {};
    for (int d = -border_; d <= border_; ++d) {
      const auto& of_cell = counts_[l_.at(i + d, j)];
      const double w = weight_[static_cast<size_t>(d + border_)];
      for (size_t k = 0; k < classes; ++k) h[k] += w * of_cell[k];
    }
    done_[at] = j;
    return h;
  }

  const core::Lattice& l_;
  const Counts& counts_;
  const std::vector<double>& weight_;
  int border_;
  std::vector<Histogram> along_;  ///< a ring of rows
  std::vector<int> done_;         ///< the row that each holds
};

}  // namespace

const double ground_populations_reach = (reach(sigma) + 1) * cell;

LowerPopulations lower_populations(const core::Block& b, size_t own, double around, const std::vector<ReturnOverGround>& returns,
                                   double noise) {
  const int border = reach(sigma);
  const core::Lattice l = lattice_around(b, own, cell, around, border);
  const Raster none(l.nx, l.ny, std::numeric_limits<float>::quiet_NaN());
  LowerPopulations out{l, none, none};

  Counts counts(l.size(), Counts::value_type{});
  std::vector<char> suspect(l.size(), 0);
  for (size_t p = 0; p < b.size(); ++p) {
    const double k = std::floor((static_cast<double>(returns[p].above) - lowest) / width);
    if (!(k >= 0.0 && k < classes)) continue;
    const CellIndex at = cell_of(l, b, p);
    if (!none.holds(at.i, at.j)) continue;
    const size_t c = l.at(at.i, at.j);
    std::uint16_t& n = counts[c][static_cast<size_t>(k)];
    if (n < std::numeric_limits<std::uint16_t>::max()) ++n;
    if (returns[p].spread > rough * noise) suspect[c] = 1;
  }
  const std::vector<double> weight = gaussian(border);
  const auto around_cell = [&](size_t c, const auto& take) {
    for (int dj = -border; dj <= border; ++dj)
      for (int di = -border; di <= border; ++di)
        take(weight[static_cast<size_t>(di + border)] * weight[static_cast<size_t>(dj + border)],
             static_cast<size_t>(static_cast<std::ptrdiff_t>(c) + std::ptrdiff_t{dj} * l.nx + di));
  };
  Histograms histograms(l, counts, weight);
  std::vector<std::pair<size_t, TwoPopulations>> found;
  std::vector<char> near_found(l.size(), 0);
  for (int j = border; j + border < l.ny; ++j)
    for (int i = border; i + border < l.nx; ++i) {
      const size_t c = l.at(i, j);
      if (!suspect[c]) continue;
      const Histogram h = histograms.at(i, j);
      const TwoPopulations two = populations_of(h, noise);
      if (two.gap <= 0.0) continue;
      found.emplace_back(c, two);
      around_cell(c, [&](double, size_t near) { near_found[near] = 1; });
    }
  const std::vector<OfStrip> strips = by_strip(b, l, returns, near_found);
  for (const auto& [c, two] : found) {
    std::map<std::uint16_t, std::pair<double, double>> sums;  // weights and heights
    around_cell(c, [&](double w, size_t near) {
      auto s =
          std::lower_bound(strips.begin(), strips.end(), near, [](const OfStrip& of, size_t cell_number) { return of.cell < cell_number; });
      for (; s != strips.end() && s->cell == near; ++s) {
        auto& [n, sum] = sums[s->strip];
        n += w * static_cast<double>(s->count), sum += w * static_cast<double>(s->sum);
      }
    });
    double lowest_mean = std::numeric_limits<double>::infinity(), highest_mean = -lowest_mean;
    for (const auto& [strip, of] : sums) {
      if (of.first < strip_fewest) continue;
      lowest_mean = std::min(lowest_mean, unit * of.second / of.first);
      highest_mean = std::max(highest_mean, unit * of.second / of.first);
    }
    if (highest_mean - lowest_mean > by_strips * two.gap) continue;
    out.middle.value[c] = static_cast<float>(two.lower.mean);
    out.spread.value[c] = static_cast<float>(two.lower.spread);
  }
  return out;
}

}  // namespace swath::filters
