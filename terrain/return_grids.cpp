// SPDX-License-Identifier: GPL-3.0-or-later
// Intensity: Höfle & Pfeifer 2007, "Correction of laser scanning intensity data: data and model-driven approaches", the range and incidence
// terms of the data-driven radar equation for extended Lambertian targets. Deviation: attenuation by the air (about 1 dB over 1 km of
// difference in range) is left out. Sums are of integers (1/256 of a unit), so that the order of the points has no say.
#include "terrain/return_grids.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/error.h"
#include "core/relief.h"
#include "terrain/voids.h"

namespace swath::terrain {
namespace {

std::optional<size_t> cell_of(const core::Block& b, size_t r, const core::Lattice& w) {
  if (!std::isfinite(b.x[r]) || !std::isfinite(b.y[r])) return std::nullopt;
  const std::int64_t i = core::cell_index(b.x[r] + b.origin.x(), w.cell) - w.i0;
  const std::int64_t j = core::cell_index(b.y[r] + b.origin.y(), w.cell) - w.j0;
  if (i < 0 || j < 0 || i >= w.nx || j >= w.ny) return std::nullopt;
  return w.at(static_cast<int>(i), static_cast<int>(j));
}

}  // namespace

double halo(const DensityOptions& o) { return o.max_gap.value + o.cell.value; }

core::Grid density(const core::Block& b, const core::Lattice& window, const DensityOptions& o, bool pulses) {
  if (window.cell != o.cell.value) throw core::Error("the window's cell is not the option's", "terrain.density");
  core::Grid g(window);
  g.count.assign(window.size(), 0);
  std::vector<std::uint32_t> usable;
  for (std::uint32_t r = 0; r < b.size(); ++r) {
    if (!core::is_usable(b, r)) continue;
    usable.push_back(r);
    const auto at = cell_of(b, r, window);
    if (!at) continue;
    g.height[*at] = 0.0f;  // known, whatever the number of its pulses
    if (!pulses || b.return_number.empty() || b.return_number[r] <= 1) ++g.count[*at];
  }
  give_void_reasons(g, b, usable, o.max_gap.value);
  for (size_t k = 0; k < window.size(); ++k) {
    if (g.reason[k] == core::Void::no_data) continue;
    g.height[k] = static_cast<float>(g.count[k] / (window.cell * window.cell));
    g.reason[k] = core::Void::none;
  }
  return g;
}

void set_incidence(core::Block& b, const core::Grid& terrain, const std::vector<Eigen::Vector3d>& scanner) {
  core::Lattice inner = terrain.lattice;
  ++inner.i0, ++inner.j0, inner.nx -= 2, inner.ny -= 2;
  if (inner.nx <= 0 || inner.ny <= 0) return;
  const core::Gradients g = core::gradients(terrain, inner);
  core::add_columns(b, {core::Column::incidence});
  for (size_t r = 0; r < b.size(); ++r) {
    const Eigen::Vector3d beam = scanner[r] - Eigen::Vector3d(b.x[r], b.y[r], b.z[r]);
    const auto at = cell_of(b, r, inner);
    if (!at || !beam.allFinite() || std::isnan(g.east[*at])) continue;
    const Eigen::Vector3d normal(-static_cast<double>(g.east[*at]), -static_cast<double>(g.north[*at]), 1.0);
    b.incidence[r] = static_cast<float>(std::atan2(beam.cross(normal).norm(), beam.dot(normal)));
  }
}

core::Grid intensity(const core::Block& b, const core::Lattice& window, const IntensityOptions& o) {
  if (window.cell != o.cell.value) throw core::Error("the window's cell is not the option's", "terrain.intensity");
  core::Grid g(window);
  g.count.assign(window.size(), 0);
  std::vector<std::int64_t> sum(window.size(), 0);
  for (size_t r = 0; r < b.size(); ++r) {
    if (!core::is_usable(b, r) || (!b.return_count.empty() && b.return_count[r] > 1)) continue;
    const auto at = cell_of(b, r, window);
    if (!at) continue;
    double value = static_cast<double>(b.intensity[r]);
    if (!b.range.empty() && b.range[r] > 0.0f) value *= std::pow(static_cast<double>(b.range[r]) / o.reference.value, 2);
    if (!b.incidence.empty() && std::isfinite(b.incidence[r]))
      value /= std::cos(std::min(static_cast<double>(std::abs(b.incidence[r])), o.steepest.value));
    ++g.count[*at];
    sum[*at] += std::llround(256.0 * value);
  }
  for (size_t k = 0; k < window.size(); ++k) {
    if (g.count[k] == 0) continue;
    g.height[k] = static_cast<float>(static_cast<double>(sum[k]) / 256.0 / g.count[k]);
    g.reason[k] = core::Void::none;
  }
  return g;
}

core::Grid canopy(const core::Grid& surface, const core::Grid& terrain) {
  if (!(surface.lattice == terrain.lattice))
    throw core::Error("surface and terrain have different cells", "terrain.canopy", "give terrain.dsm and terrain.dtm the same cell");
  core::Grid g(terrain.lattice);
  const bool has_sigma = !surface.sigma.empty() && !terrain.sigma.empty();
  if (has_sigma) g.sigma.assign(g.height.size(), std::numeric_limits<float>::quiet_NaN());
  for (size_t k = 0; k < g.height.size(); ++k) {
    g.reason[k] = terrain.reason[k] != core::Void::none ? terrain.reason[k] : surface.reason[k];
    if (g.reason[k] != core::Void::none) continue;
    g.height[k] = std::max(0.0f, surface.height[k] - terrain.height[k]);
    if (has_sigma) g.sigma[k] = std::hypot(surface.sigma[k], terrain.sigma[k]);
  }
  return g;
}

}  // namespace swath::terrain
