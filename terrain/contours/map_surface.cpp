// SPDX-License-Identifier: GPL-3.0-or-later
// Flat triangles are the known fault of a TIN of contours. Thibault and Gold 2000 put the skeleton of the flat part in their place, with
// heights by distance. Here the part is opened and bends as little as it can: a valley goes on falling, a ridge or top goes on rising over
// its last contour.
#include "terrain/contours/map_surface.h"

#include <algorithm>
#include <set>

#include "terrain/tin/tin.h"
#include "terrain/tin/tin_surface.h"
#include "terrain/water/line_network.h"

namespace swath::terrain {
namespace {

constexpr double flat_rise = 0.9;   // of the interval: most that a flat part leaves its contour
constexpr double exit_rise = 0.25;  // the same beyond the two heights of a triangle that leads out of it

enum class Kind : std::uint8_t { sloping, flat, exit };

/// For each vertex whether it lies on a contour.
std::vector<bool> on_contours(const Tin& tin, const MapContent& content) {
  const std::vector<double> levels = levels_in(content);
  std::vector<bool> out(tin.z.size());
  for (size_t v = 0; v < out.size(); ++v)
    out[v] = tin.row[v] >= content.spots.size() && std::binary_search(levels.begin(), levels.end(), tin.z[v]);
  return out;
}

std::vector<Kind> kinds_of(const Tin& tin, const MapContent& content) {
  const std::vector<bool> contour = on_contours(tin, content);
  std::vector<Kind> kinds(tin.size(), Kind::sloping);
  for (size_t t = 0; t < tin.size(); ++t) {
    const auto [a, b, c] = tin.triangles[t];
    if (contour[a] && contour[b] && contour[c] && tin.z[a] == tin.z[b] && tin.z[a] == tin.z[c]) kinds[t] = Kind::flat;
  }
  for (size_t t = 0; t < tin.size(); ++t) {
    if (kinds[t] != Kind::flat) continue;
    for (size_t k = 0; k < 3; ++k) {
      const std::int32_t next = tin.across[t][k];
      if (next < 0 || kinds[next] != Kind::sloping) continue;
      const std::pair<std::int32_t, std::int32_t> edge = std::minmax(tin.triangles[t][(k + 1) % 3], tin.triangles[t][(k + 2) % 3]);
      if (!std::binary_search(tin.constrained.begin(), tin.constrained.end(), edge)) kinds[next] = Kind::exit;
    }
  }
  return kinds;
}

Tin triangulated(const MapContent& content, const core::Lattice& lattice, const Eigen::Vector3d& origin, const MapSurfaceOptions& o) {
  std::vector<NetworkLine> lines;
  for (const MapLine& l : content.lines) {
    NetworkLine n{{}, l.place, 0.0, !l.contour};
    for (const Eigen::Vector3d& v : l.vertices) n.vertices.push_back(v - origin);
    lines.push_back(std::move(n));
  }
  NetworkOptions network;
  network.spacing = core::Metres(lattice.cell);
  network.tolerance = core::Metres(o.tolerance);
  core::Block spots;
  std::vector<std::uint32_t> rows;
  for (const Eigen::Vector3d& s : content.spots) {
    rows.push_back(static_cast<std::uint32_t>(rows.size()));
    spots.x.push_back(s.x() - origin.x()), spots.y.push_back(s.y() - origin.y()), spots.z.push_back(s.z());
  }
  return triangulate(spots, rows, line_network(lines, network, origin), 0.5 * o.max_edge);
}

struct Range {
  double low, high;
};
Range heights_in(const Tin& tin, std::int32_t t) {
  const auto [a, b, c] = tin.triangles[static_cast<size_t>(t)];
  const auto [low, high] = std::minmax({tin.z[a], tin.z[b], tin.z[c]});
  return {low, high};
}

/// Heights and parts of all cells as the triangles have them.
MapSurface read_triangles(const Tin& tin, const std::vector<std::int32_t>& triangles, const std::vector<Kind>& kinds,
                          const Eigen::Vector3d& origin, const core::Lattice& l) {
  MapSurface out{core::Grid(l), std::vector<MapPart>(l.size(), MapPart::none), std::vector<float>(l.size(), 0.0f), {}};
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      const size_t c = l.at(i, j);
      const std::int32_t t = triangles[c];
      if (t < 0) continue;
      const double z = height_in(tin, t, l.centre_x(i) - origin.x(), l.centre_y(j) - origin.y());
      const auto [low, high] = heights_in(tin, t);
      const double share = high > low ? std::clamp((z - low) / (high - low), 0.0, 1.0) : 0.0;
      const bool sloping = kinds[static_cast<size_t>(t)] == Kind::sloping;
      out.grid.height[c] = static_cast<float>(z);
      out.grid.reason[c] = core::Void::none;
      out.part[c] = sloping ? MapPart::between : MapPart::kept;
      out.between[c] = sloping ? static_cast<float>(4.0 * share * (1.0 - share)) : 1.0f;
    }
  return out;
}

}  // namespace

std::vector<double> levels_in(const MapContent& content) {
  std::set<double> levels;
  for (const MapLine& l : content.lines)
    if (l.contour) levels.insert(l.vertices.front().z());
  return {levels.begin(), levels.end()};
}

MapSurface map_surface(const MapContent& content, const core::Lattice& lattice, const MapSurfaceOptions& o) {
  const Eigen::Vector3d origin(0.5 * (lattice.west() + lattice.east()), 0.5 * (lattice.south() + lattice.north()), 0.0);
  const Tin tin = triangulated(content, lattice, origin, o);
  const std::vector<Kind> kinds = kinds_of(tin, content);
  const std::vector<std::int32_t> triangles = triangles_at_centres(tin, origin, lattice);
  MapSurface out = read_triangles(tin, triangles, kinds, origin, lattice);
  if (o.keep_flats) return out;

  std::vector<std::uint8_t> open(lattice.size()), filled;
  for (size_t c = 0; c < open.size(); ++c) open[c] = out.part[c] == MapPart::kept;
  std::vector<Eigen::Vector3d> known;
  for (size_t v = 0; v < tin.z.size(); ++v) known.emplace_back(tin.x[v] + origin.x(), tin.y[v] + origin.y(), tin.z[v]);
  out.flats = fill_by_least_bending(out.grid, open, known, o.most_cells, filled);
  for (size_t c = 0; c < filled.size(); ++c) {
    if (!filled[c]) continue;
    const auto [low, high] = heights_in(tin, triangles[c]);
    const double rise = o.interval * (kinds[static_cast<size_t>(triangles[c])] == Kind::flat ? flat_rise : exit_rise);
    out.grid.height[c] = static_cast<float>(std::clamp<double>(out.grid.height[c], low - rise, high + rise));
    out.part[c] = MapPart::flat;
  }
  return out;
}

}  // namespace swath::terrain
