// SPDX-License-Identifier: GPL-3.0-or-later
// Sigma of a cell is the root of the sum of two variances.
//   Points: s_k^2 = sigma_v^2 + (|slope| sigma_h)^2 / 2 per vertex (sigma_h is radial: half its variance lies along the slope), then
//     correlation (sum w_k s_k)^2 + (1 - correlation) sum w_k^2 s_k^2 with barycentric weights w. Correlation is one number for all pairs
//     of a triangle's points; the two limits differ by a factor of at most sqrt(3).
//   Between points: b/(2r) (r^2 - d^2), d the distance from the circumcentre, r the circumradius: the bound of linear interpolation on a
//     triangle for second derivatives up to K, K/2 (r^2 - d^2) (Waldron 1998, "The error in linear interpolation at the vertices of a
//     simplex"), with K = b/r. b is the rms change of slope to the neighbouring triangles. Noise of the points raises b as well, so in
//     dense data the term is on the safe side by about the points' relative noise. Neighbours count only where r + r_neighbour <=
//     max_edge / 2, which keeps the rule within the halo (the neighbour's disc shares an edge with the triangle's: all of it lies within
//     2 r + 2 r_neighbour of the place); where none does, b is the option unknown_bend.
#include "terrain/dtm.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/error.h"
#include "terrain/tin_surface.h"
#include "terrain/voids.h"

namespace swath::terrain {
namespace {

/// Sigma at places of a TIN, by the terms above.
class SigmaModel {
 public:
  SigmaModel(const Tin& tin, const DtmOptions& o) : tin_(tin), options_(o), neighbours_(neighbours(tin)) {}

  double at(std::int32_t t, double x, double y) const {
    const Circumcircle circle = circumcircle(tin_, t);
    const auto w = weights(tin_, t, x, y);
    const double slope_squared = gradient(tin_, t).squaredNorm();
    double sum = 0.0, sum_of_squares = 0.0;
    for (size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<size_t>(tin_.triangles[t][k]);
      double variance = static_cast<double>(tin_.sigma_v[v]) * static_cast<double>(tin_.sigma_v[v]);
      if (!tin_.sigma_h.empty())
        variance += 0.5 * slope_squared * static_cast<double>(tin_.sigma_h[v]) * static_cast<double>(tin_.sigma_h[v]);
      sum += w[k] * std::sqrt(variance);
      sum_of_squares += w[k] * w[k] * variance;
    }
    const double points = options_.correlation * sum * sum + (1.0 - options_.correlation) * sum_of_squares;
    const double dx = x - circle.x, dy = y - circle.y;
    const double between =
        bend(t, circle.radius) / (2.0 * circle.radius) * std::max(0.0, circle.radius * circle.radius - dx * dx - dy * dy);
    return std::sqrt(points + between * between);
  }

 private:
  double bend(std::int32_t t, double radius) const {
    double sum = 0.0;
    int n = 0;
    for (const std::int32_t other : neighbours_[t]) {
      if (other < 0 || radius + circumcircle(tin_, other).radius > 0.5 * options_.max_edge.value) continue;
      sum += (gradient(tin_, other) - gradient(tin_, t)).squaredNorm();
      ++n;
    }
    return n > 0 ? std::sqrt(sum / n) : options_.unknown_bend;
  }

  const Tin& tin_;
  const DtmOptions& options_;
  std::vector<std::array<std::int32_t, 3>> neighbours_;
};

}  // namespace

double halo(const DtmOptions& options) { return options.max_edge.value + options.cell.value; }

std::vector<std::uint32_t> terrain_rows(const core::Block& block, const DtmOptions& options) {
  std::vector<std::uint32_t> rows;
  for (size_t i = 0; i < block.size(); ++i) {
    if (!core::is_usable(block, i)) continue;
    const bool is_terrain = block.classification.empty() ||
                            std::find(options.classes.begin(), options.classes.end(), block.classification[i]) != options.classes.end();
    if (is_terrain) rows.push_back(static_cast<std::uint32_t>(i));
  }
  return rows;
}

Tin terrain_tin(const core::Block& block, const DtmOptions& options) {
  return triangulate(block, terrain_rows(block, options), 0.5 * options.max_edge.value);
}

core::Grid dtm(const core::Block& block, const core::Lattice& window, const DtmOptions& options, const Breaklines* lines) {
  if (window.cell != options.cell.value) throw core::Error("the window's cell is not the option's", "terrain.dtm");
  std::vector<std::uint32_t> rows = terrain_rows(block, options);
  Constraints constraints;
  if (lines) {
    constraints = lines->near(window, halo(options));
    rows = lines->kept(block, rows, constraints);
  }
  const Tin tin = triangulate(block, rows, constraints, 0.5 * options.max_edge.value);
  const std::vector<std::int32_t> triangle = triangles_at_centres(tin, block.origin, window);

  core::Grid grid(window);
  grid.count = count_points(block, rows, window);
  const bool has_sigma = !block.sigma_v.empty();
  if (has_sigma) grid.sigma.assign(window.size(), std::numeric_limits<float>::quiet_NaN());
  const std::optional<SigmaModel> sigma = has_sigma ? std::make_optional<SigmaModel>(tin, options) : std::nullopt;
  for (int j = 0; j < window.ny; ++j)
    for (int i = 0; i < window.nx; ++i) {
      const size_t at = window.at(i, j);
      if (triangle[at] < 0) continue;
      const double x = window.centre_x(i) - block.origin.x(), y = window.centre_y(j) - block.origin.y();
      grid.height[at] = static_cast<float>(block.origin.z() + height_in(tin, triangle[at], x, y));
      if (sigma) grid.sigma[at] = static_cast<float>(sigma->at(triangle[at], x, y));
    }
  give_void_reasons(grid, block, rows, options.max_edge.value);
  if (lines) lines->apply(grid);
  return grid;
}

}  // namespace swath::terrain
