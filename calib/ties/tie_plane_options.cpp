// SPDX-License-Identifier: GPL-3.0-or-later
// What grows with the range: the footprint, and what an angle moves a return by. From 40 m a roof of 4 m is a good plane, and ground that
// is even to 8 cm over 12 m is no plane to records of 2 cm.
#include "calib/ties/tie_plane_options.h"

#include <algorithm>
#include <cmath>

namespace swath::calib {
namespace {

constexpr double full_height = 400.0;                         // m: sizes no longer grow
constexpr double largest_piece = 12.0, smallest_piece = 4.0;  // m
constexpr double piece_per_height = 0.09;                     // 5 deg of the swath
constexpr double extents_of_piece = 8.0;
constexpr double roughness_of_largest = 0.08;              // m
constexpr double least_over_noise = 2.5;                   // the roughness admits the records' noise
constexpr double widest_margin = 0.4, least_margin = 0.1;  // m
constexpr double returns_per_cell = 10.0;
constexpr int min_planes = 1200, max_planes = 100000;
constexpr double planes_per_second = 2.0;
constexpr double smallest_cell = 0.25, smallest_cell_high = 1.5, largest_cell = 5.0;  // m

}  // namespace

FlownScale scale_of(double height, double density, const core::SensorSigma& s) {
  FlownScale out;
  if (height > 0.0) out.height = height;  // not NaN
  if (density > 0.0) out.density = density;
  out.noise = std::hypot(s.range.value, s.beam_divergence.value / 4.0 * out.height);
  return out;
}

TiePlaneOptions sized(TiePlaneOptions o, const FlownScale& s) {
  const double share = s.height > 0.0 ? std::min(s.height / full_height, 1.0) : 1.0;
  if (!o.piece)
    o.piece = core::Metres(s.height > 0.0 ? std::clamp(piece_per_height * s.height, smallest_piece, largest_piece) : largest_piece);
  const double piece = std::min(o.piece->value, largest_piece);
  if (!o.extent) o.extent = core::Metres(o.piece->value / extents_of_piece);
  if (!o.roughness)
    o.roughness = core::Metres(
        std::min(roughness_of_largest, std::max(roughness_of_largest * std::sqrt(piece / largest_piece), least_over_noise * s.noise)));
  if (!o.margin) o.margin = core::Metres(std::max(least_margin, widest_margin * share));
  if (!o.cell && s.density > 0.0)
    o.cell = core::Metres(
        std::clamp(std::sqrt(returns_per_cell / s.density), std::max(smallest_cell, smallest_cell_high * share), largest_cell));
  if (!o.planes) o.planes = std::clamp(static_cast<int>(std::min(planes_per_second * s.seconds, 1e9)), min_planes, max_planes);
  return o;
}

}  // namespace swath::calib
