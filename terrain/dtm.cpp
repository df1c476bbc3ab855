// SPDX-License-Identifier: GPL-3.0-or-later
// Sigma of a cell is the root of a sum of variances, at barycentric weights w in a triangle, with the terms and the reach s of
// terrain/roughness.h, which the points around the cell show:
//   what neighbouring points share: (sum w_k c_k)^2, c_k^2 = s_k^2 - noise, at least correlation s_k^2, from the points' own
//     s_k^2 = sigma_v^2 + (|slope| sigma_h)^2 / 2 (sigma_h is radial: half its variance lies along the slope);
//   what they do not share (ranging, vegetation taken for ground): noise (sum w_k^2). Smoothing leaves a share l_k of it, in common: noise
//     (sum w_k sqrt(l_k))^2; only of what the points' own sigmas explain;
//   scatter beyond that, as smoothing finds it near by: it is one-sided (echoes of low plants merged with that
//     of the ground), no mean takes it out. Of a quantity that only adds, whose density falls evenly to nothing where the ground filter
//     refuses, the mean's square is twice the variance: sum w_k 2 (scatter_k - explained). (An exponential density: once; an even one:
//     three times.) Without smoothing (noise - explained) (sum w_k^2);
//   the terrain between them: uneven s + curved s^2 / 4.
// Points without a sigma of their own get s_k^2 = noise.
// Where too few triangles stand around a place to estimate these, noise is 0 and the terrain may bend by the option unknown_bend b between
// a triangle and the next: (b (r^2 - d^2) / (2 r))^2, circumradius r, d from its centre, the bound of Waldron 1998, "The error in linear
// interpolation at the vertices of a simplex".
#include "terrain/dtm.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/error.h"
#include "terrain/roughness.h"
#include "terrain/tin/natural_neighbours.h"
#include "terrain/tin/smoothing.h"
#include "terrain/tin/tin_surface.h"
#include "terrain/voids.h"

namespace swath::terrain {
namespace {

/// Side of the blocks on which roughness is estimated.
double roughness_block(const DtmOptions& o) { return o.max_edge.value / 6.0; }

/// The scatter around a vertex is estimated from some fifteen points: within a standard deviation of that more is nothing.
constexpr double by_chance = 1.4;
constexpr double one_sided = 2.0;  // mean square over variance

/// Sigma at places of a TIN, by the terms above.
class SigmaModel {
 public:
  /// `roughness`: of the points as they are. `smoothed`: empty without smoothing.
  SigmaModel(const Tin& tin, const RoughnessMap& roughness, const Smoothed& smoothed, const DtmOptions& o)
      : tin_(tin), roughness_(roughness), smoothed_(smoothed), options_(o) {}

  double at(std::int32_t t, double x, double y) const {
    const Roughness rough = roughness_.at(x, y);
    const auto w = weights(tin_, t, x, y);
    const double slope_squared = gradient(tin_, t).squaredNorm();
    double shared = 0.0, apart = 0.0, together = 0.0, excess = 0.0;
    for (size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<size_t>(tin_.triangles[t][k]);
      double variance = rough.noise;
      if (!tin_.sigma_v.empty()) variance = static_cast<double>(tin_.sigma_v[v]) * static_cast<double>(tin_.sigma_v[v]);
      if (!tin_.sigma_h.empty())
        variance += 0.5 * slope_squared * static_cast<double>(tin_.sigma_h[v]) * static_cast<double>(tin_.sigma_h[v]);
      // max() in this order hands on a variance that is NaN.
      shared += w[k] * std::sqrt(std::max(variance - rough.noise, options_.correlation * variance));
      const double explained = std::min(rough.noise, variance),
                   left = smoothed_.left.empty() ? 1.0 : static_cast<double>(smoothed_.left[v]);
      if (left < 1.0)
        together += w[k] * std::sqrt(left * explained);
      else
        apart += w[k] * w[k] * explained;
      excess += beyond(v, w[k], rough.noise, explained);
    }
    const double own = together * together + apart + excess;
    const double s = reach_of(tin_, t, w, x, y);
    double between = rough.uneven * s + 0.25 * rough.curved * s * s;
    if (!rough.known) {
      const Circumcircle circle = circumcircle(tin_, t);
      const double dx = x - circle.x, dy = y - circle.y;
      const double power = std::max(0.0, circle.radius * circle.radius - dx * dx - dy * dy);
      between = std::pow(0.5 * options_.unknown_bend * power / circle.radius, 2);
    }
    return std::sqrt(shared * shared + own + between);
  }

 private:
  /// m^2: of a vertex's scatter beyond what its own sigma explains.
  double beyond(size_t v, double w, double noise, double explained) const {
    const double scatter = smoothed_.scatter.empty() ? std::nan("") : static_cast<double>(smoothed_.scatter[v]);
    return std::isnan(scatter) ? w * w * (noise - explained) : w * one_sided * std::max(0.0, scatter - by_chance * explained);
  }

  const Tin& tin_;
  const RoughnessMap& roughness_;
  const Smoothed& smoothed_;
  const DtmOptions& options_;
};

bool smooths(const DtmOptions& o) { return o.smoothing.value > 0.0 && !o.key_points; }

/// Metres about the window where heights are read.
double around_read(const DtmOptions& o) { return o.interpolation == Interpolation::natural_neighbour ? o.max_edge.value : 0.0; }

/// Metres about the window where triangles have a say: where roughness is estimated, natural neighbours are, and heights are smoothed.
double around_window(const DtmOptions& o) {
  return std::max(RoughnessMap::reach(roughness_block(o)), around_read(o) + (smooths(o) ? smoothing_reach(o.smoothing.value) : 0.0));
}

Rectangle reached(const core::Lattice& window, const Eigen::Vector3d& origin, double around) {
  return {window.west() - origin.x() - around, window.south() - origin.y() - around, window.east() - origin.x() + around,
          window.north() - origin.y() + around};
}

}  // namespace

double triangulated_border(const DtmOptions& options) { return around_window(options); }

double halo(const DtmOptions& options) {
  // A place needs the points within max_edge to know its triangle.
  return options.max_edge.value + triangulated_border(options) + options.cell.value;
}

std::vector<std::uint32_t> terrain_rows(const core::Block& block, const DtmOptions& options) {
  std::vector<std::uint32_t> rows;
  for (size_t i = 0; i < block.size(); ++i) {
    if (!core::is_usable(block, i)) continue;
    if (options.key_points && (block.flags.empty() || !(block.flags[i] & core::flag::key_point))) continue;
    const bool is_terrain = block.classification.empty() ||
                            std::find(options.classes.begin(), options.classes.end(), block.classification[i]) != options.classes.end();
    if (is_terrain) rows.push_back(static_cast<std::uint32_t>(i));
  }
  return rows;
}

core::Grid dtm(const core::Block& block, const core::Lattice& window, const DtmOptions& options, const Breaklines* lines,
               std::uint64_t* left_out) {
  if (window.cell != options.cell.value) throw core::Error("the window's cell is not the option's", "terrain.dtm");
  std::vector<std::uint32_t> rows = terrain_rows(block, options);
  Constraints constraints;
  if (lines) {
    constraints = lines->near(window, halo(options));
    rows = lines->kept(block, rows, constraints);
  }
  Tin tin = triangulate(block, rows, constraints, 0.5 * options.max_edge.value, reached(window, block.origin, around_window(options)));
  const RoughnessMap roughness(tin, block.origin, window, roughness_block(options));
  Smoothed smoothed;
  if (smooths(options))
    smoothed = smooth_heights(tin, block.size(), options.smoothing.value, reached(window, block.origin, around_read(options)));
  const std::vector<std::int32_t> triangle = triangles_at_centres(tin, block.origin, window);

  if (left_out)
    *left_out = static_cast<std::uint64_t>(std::count_if(tin.duplicates.begin(), tin.duplicates.end(), [&](const Place& p) {
      const auto cell = [&](double v) { return core::cell_index(v, window.cell); };
      return window.holds(static_cast<int>(cell(p.x + block.origin.x()) - window.i0),
                          static_cast<int>(cell(p.y + block.origin.y()) - window.j0));
    }));
  core::Grid grid(window);
  grid.count = count_points(block, rows, window);
  grid.sigma.assign(window.size(), std::numeric_limits<float>::quiet_NaN());
  const bool natural = options.interpolation == Interpolation::natural_neighbour;
  const SigmaModel sigma(tin, roughness, smoothed, options);
  std::optional<NaturalNeighbours> neighbourhood;
  if (natural) neighbourhood.emplace(tin);
  const auto read = [&](int i, int j) {
    const size_t at = window.at(i, j);
    if (triangle[at] < 0) return;
    const double x = window.centre_x(i) - block.origin.x(), y = window.centre_y(j) - block.origin.y();
    const double z = natural ? neighbourhood->height(triangle[at], x, y) : height_in(tin, triangle[at], x, y);
    grid.height[at] = static_cast<float>(block.origin.z() + z);
    grid.sigma[at] = static_cast<float>(sigma.at(triangle[at], x, y));
  };
  constexpr int side = 32;  // squares of cells: the vertices of one row's triangles are far apart in memory
  for (int j0 = 0; j0 < window.ny; j0 += side)
    for (int i0 = 0; i0 < window.nx; i0 += side)
      for (int j = j0; j < std::min(j0 + side, window.ny); ++j)
        for (int i = i0; i < std::min(i0 + side, window.nx); ++i) read(i, j);
  give_void_reasons(grid, block, rows, options.max_edge.value);
  if (lines) lines->apply(grid);
  return grid;
}

}  // namespace swath::terrain
