// SPDX-License-Identifier: GPL-3.0-or-later
// Two normal distributions of one width against one, by EM (Dempster 1977). Returns of one wire are spread evenly over the beam's width,
// which two distributions fit better than one, too: two halves of an even spread lie 3.5 of their sigmas apart. Two wires must lie farther.
#include "terrain/corridor/bundles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "core/statistics.h"

namespace swath::terrain {
namespace {

constexpr double least_apart = 4.0;    // sigmas of one wire's returns
constexpr double least_spacing = 0.1;  // m
constexpr double least_share = 0.25;   // of the returns, of each wire
constexpr size_t bundle_fewest = 20;   // returns
constexpr size_t bundle_fewest_of_line = 12;
constexpr double least_of_line = 0.15;  // of a flight line's returns, at each place
constexpr double beside_strand = 1.0;   // m from the strand: no part of it

struct Two {
  double low, high, sigma;
};

/// Two places of the values, where they are two.
std::optional<Two> two_places(const std::vector<double>& values, const std::vector<std::uint16_t>& line) {
  const double middle = core::median(values);
  Two t{core::quantile(values, 0.2), core::quantile(values, 0.8), 0.0};
  t.sigma = std::max(1e-3, 0.25 * (t.high - t.low));
  double share = 0.5;
  std::vector<double> upper(values.size());
  for (int round = 0; round < 100; ++round) {
    double n = 0.0, high = 0.0, low = 0.0, squares = 0.0;
    for (size_t k = 0; k < values.size(); ++k) {
      const double a = share * std::exp(-0.5 * std::pow((values[k] - t.high) / t.sigma, 2)),
                   b = (1.0 - share) * std::exp(-0.5 * std::pow((values[k] - t.low) / t.sigma, 2));
      upper[k] = a + b > 0.0 ? a / (a + b) : (values[k] > middle ? 1.0 : 0.0);
      n += upper[k];
      high += upper[k] * values[k];
      low += (1.0 - upper[k]) * values[k];
    }
    const auto all = static_cast<double>(values.size());
    if (n < 1.0 || all - n < 1.0) return std::nullopt;
    t.high = high / n, t.low = low / (all - n), share = n / all;
    for (size_t k = 0; k < values.size(); ++k)
      squares += upper[k] * std::pow(values[k] - t.high, 2) + (1.0 - upper[k]) * std::pow(values[k] - t.low, 2);
    t.sigma = std::max(1e-3, std::sqrt(squares / all));
  }
  if (share < least_share || share > 1.0 - least_share || t.high - t.low < std::max(least_spacing, least_apart * t.sigma))
    return std::nullopt;
  std::map<std::uint16_t, std::array<double, 2>> of_line;
  for (size_t k = 0; k < values.size(); ++k) ++of_line[line[k]][upper[k] > 0.5 ? 1 : 0];
  for (const auto& [id, n] : of_line)
    if (n[0] + n[1] >= static_cast<double>(bundle_fewest_of_line) && std::min(n[0], n[1]) < least_of_line * (n[0] + n[1]))
      return std::nullopt;
  return t;
}

}  // namespace

Bundle bundle_of(const std::vector<WirePoint>& points, const Strand& strand) {
  std::vector<double> across, up;
  std::vector<std::uint16_t> line;
  for (const std::uint32_t p : strand.points) {
    const Eigen::Vector2d at(points[p].x, points[p].y);
    const double v = strand.line.v(at), w = points[p].z - strand.fit.curve.z(strand.line.s(at));
    if (std::abs(v) > beside_strand || std::abs(w) > beside_strand) continue;
    across.push_back(v), up.push_back(w), line.push_back(points[p].line);
  }
  Bundle out;
  if (across.size() < bundle_fewest) return out;
  const auto sideways = two_places(across, line), upwards = two_places(up, line);
  if (sideways) out.wires *= 2, out.spacing = sideways->high - sideways->low;
  if (upwards) out.wires *= 2, out.spacing = sideways ? out.spacing : upwards->high - upwards->low;
  return out;
}

}  // namespace swath::terrain
