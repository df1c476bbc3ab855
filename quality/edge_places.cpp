// SPDX-License-Identifier: GPL-3.0-or-later
// A pulse d beyond the surveyed edge hits with the probability Phi((t - d) / s) where the edge lies at t: s is the width of the beam and
// the noise of its place. Nothing is assumed of how pulses are spaced: between the last hit and the first miss, where none fell, every
// place is as likely, and the sigma is that of an even distribution. The place is the mean over t, all places up to farthest_edge being
// alike before, and over s, which all edges share and whose sizes are alike by their logarithm; the sigma is the spread about it. So the
// sigma is true for few pulses and for many, where a curvature of the likelihood is not.
// A share of the pulses shows the wrong thing (dormers, chimneys, gaps in a roof): it limits what one of them can say.
#include "quality/edge_places.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace swath::quality {
namespace {

constexpr int steps_aside = 240;  // to either side
constexpr double step = farthest_edge / steps_aside;
constexpr int places = 2 * steps_aside + 1;
constexpr double wrong = 0.02;              // share of pulses: two sigmas of height, and what stands on roofs
constexpr double certain = 6.0;             // widths from an edge beyond which a pulse is sure to miss or hit
constexpr double widest_edge_sigma = 0.35;  // m: half the sigma of an edge that nothing is known of
constexpr std::array<double, 9> widths{0.005, 0.01, 0.02, 0.035, 0.06, 0.1, 0.16, 0.25, 0.4};  // m

double place_of(int k) { return -farthest_edge + step * k; }

using Logs = std::array<double, places>;

/// Log likelihood of a hit whose beam is u widths inside of the edge; of a miss that of -u. Between values in steps of 1/64, to 1e-4.
class HitTable {
 public:
  HitTable() {
    for (int k = 0; k < size; ++k)
      log_[static_cast<size_t>(k)] = std::log(wrong + (1.0 - 2.0 * wrong) * 0.5 * std::erfc((certain - k / fine) / std::sqrt(2.0)));
  }
  double operator()(double u) const {
    const double at = std::clamp((u + certain) * fine, 0.0, size - 1.001);
    const auto k = static_cast<size_t>(at);
    return log_[k] + (at - static_cast<double>(k)) * (log_[k + 1] - log_[k]);
  }

 private:
  static constexpr double fine = 64.0;
  static constexpr int size = 2 * static_cast<int>(certain * fine) + 1;
  std::array<double, size> log_{};
};

/// Log likelihood of every place.
Logs logs_of(const std::vector<EdgePulse>& pulses, double width) {
  static const HitTable table;
  Logs out{};
  const double sure = std::log(1.0 - wrong), not_so = std::log(wrong);
  std::array<double, places + 1> steps{};  // what far pulses add from a place on
  for (const EdgePulse& p : pulses) {
    const double at = p.out - p.wall;
    const int from = std::clamp(static_cast<int>(std::ceil((at - certain * width + farthest_edge) / step)), 0, places);
    const int to = std::clamp(static_cast<int>(std::ceil((at + certain * width + farthest_edge) / step)), 0, places);
    steps[0] += p.hit ? not_so : sure;
    steps[static_cast<size_t>(from)] -= p.hit ? not_so : sure;
    steps[static_cast<size_t>(to)] += p.hit ? sure : not_so;
    for (int k = from; k < to; ++k) {
      const double u = (place_of(k) - at) / width;
      out[static_cast<size_t>(k)] += table(p.hit ? u : -u);
    }
  }
  double sum = 0.0;
  for (size_t k = 0; k < out.size(); ++k) sum += steps[k], out[k] += sum;
  return out;
}

/// Weight, mean and mean square of the places under one width.
struct PlaceMoments {
  double log_weight = 0.0, mean = 0.0, square = 0.0, at_ends = 0.0;
};

PlaceMoments place_moments(const std::vector<EdgePulse>& pulses, double width) {
  const Logs logs = logs_of(pulses, width);
  const double best = *std::max_element(logs.begin(), logs.end());
  double sum = 0.0;
  PlaceMoments m;
  for (int k = 0; k < places; ++k) {
    const double weight = std::exp(logs[static_cast<size_t>(k)] - best), t = place_of(k);
    sum += weight, m.mean += weight * t, m.square += weight * t * t;
    if (k * step < 0.1 || (places - 1 - k) * step < 0.1) m.at_ends += weight;
  }
  m.mean /= sum, m.square /= sum, m.at_ends /= sum;
  m.log_weight = best + std::log(sum * step);
  return m;
}

}  // namespace

std::vector<EdgePlace> edge_places(const std::vector<std::vector<EdgePulse>>& edges) {
  std::array<std::vector<PlaceMoments>, widths.size()> found;
  std::array<double, widths.size()> weight{};
  for (size_t w = 0; w < widths.size(); ++w)
    for (const std::vector<EdgePulse>& pulses : edges) {
      found[w].push_back(place_moments(pulses, widths[w]));
      weight[w] += found[w].back().log_weight;
    }
  const double best = *std::max_element(weight.begin(), weight.end());
  double sum = 0.0;
  for (double& w : weight) w = std::exp(w - best), sum += w;
  std::vector<EdgePlace> out(edges.size());
  for (size_t e = 0; e < edges.size(); ++e) {
    double square = 0.0, ends = 0.0;
    for (size_t w = 0; w < widths.size(); ++w) {
      const double share = weight[w] / sum;
      out[e].at += share * found[w][e].mean, square += share * found[w][e].square, ends += share * found[w][e].at_ends;
    }
    out[e].sigma = std::sqrt(std::max(square - out[e].at * out[e].at, step * step / 12.0));
    out[e].is_shown = out[e].sigma < widest_edge_sigma && ends < 0.02;
  }
  return out;
}

double rough_edge(const std::vector<EdgePulse>& pulses) {
  std::vector<std::pair<double, int>> sorted;
  for (const EdgePulse& p : pulses) sorted.emplace_back(p.out - p.wall, p.hit ? 1 : -1);
  std::sort(sorted.begin(), sorted.end());
  // More hits before it and misses behind it by one: the sum of signs up to a place is largest at the edge; of equal ones the middle.
  int sum = 0, best = 0;
  double from = -farthest_edge, to = sorted.empty() ? farthest_edge : sorted[0].first;
  for (size_t k = 0; k < sorted.size(); ++k) {
    sum += sorted[k].second;
    const double next = k + 1 < sorted.size() ? sorted[k + 1].first : farthest_edge;
    if (sum > best) best = sum, from = sorted[k].first, to = next;
  }
  return std::clamp(0.5 * (from + to), -farthest_edge, farthest_edge);
}

}  // namespace swath::quality
