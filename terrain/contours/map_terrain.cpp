// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/contours/map_terrain.h"

#include <algorithm>
#include <array>

#include "core/error.h"

namespace swath::terrain {
namespace {

constexpr double most_model_cells = 4e8;
constexpr size_t fewest_tested = 50;
constexpr double assumed_share = 0.25;  // of the interval, where nothing can be tested
constexpr double least_share = 0.25;    // of the sigma midway, at a contour: a cell is wider than a line
constexpr double level_rounding = 1e-3;

/// The usual step from one level to the next.
double usual_step(const std::vector<double>& levels) {
  std::vector<double> steps;
  for (size_t k = 1; k < levels.size(); ++k) steps.push_back(levels[k] - levels[k - 1]);
  if (steps.empty()) return 0.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

core::Lattice lattice_around(const MapContent& content, double cell) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  const auto add = [&](const Eigen::Vector3d& p) { low = low.cwiseMin(p.head<2>()), high = high.cwiseMax(p.head<2>()); };
  for (const MapLine& l : content.lines) std::for_each(l.vertices.begin(), l.vertices.end(), add);
  std::for_each(content.spots.begin(), content.spots.end(), add);
  if (!(low.x() <= high.x()))
    throw core::Error("the map has no height", "", "contours, spot heights or breaklines with heights are needed");
  if ((high - low).prod() / (cell * cell) > most_model_cells)
    throw core::Error("the model would have more than 400 million cells", "", "choose a wider cell, or a part of the map");
  return core::lattice_of(cell, low.x(), low.y(), std::nextafter(high.x(), 1e300), std::nextafter(high.y(), 1e300));
}

/// Height of the surface between four cell centres and the part of the cell that holds the place; nothing where one has no height.
std::optional<std::pair<double, MapPart>> read_at(const MapSurface& s, const Eigen::Vector3d& p) {
  const core::Lattice& l = s.grid.lattice;
  const double x = p.x() / l.cell - 0.5 - static_cast<double>(l.i0), y = p.y() / l.cell - 0.5 - static_cast<double>(l.j0);
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
  if (!l.holds(i, j) || !l.holds(i + 1, j + 1)) return std::nullopt;
  const double u = x - i, v = y - j;
  const auto z = [&](int a, int b) { return static_cast<double>(s.grid.height[l.at(a, b)]); };
  const double height = (1 - u) * ((1 - v) * z(i, j) + v * z(i, j + 1)) + u * ((1 - v) * z(i + 1, j) + v * z(i + 1, j + 1));
  if (std::isnan(height)) return std::nullopt;
  return std::pair{height, s.part[l.at(u < 0.5 ? i : i + 1, v < 0.5 ? j : j + 1)]};
}

struct Squares {
  size_t n = 0;
  double sum = 0.0;
  double rms() const { return n > 0 ? std::sqrt(sum / static_cast<double>(n)) : std::nan(""); }
};
using OfParts = std::array<Squares, map_part_names.size()>;

/// Squared errors at the contours midway between those of every `step`-th level, which alone are used with everything else.
OfParts errors_without(const MapContent& content, double lowest, int step, const core::Lattice& lattice, const MapSurfaceOptions& o) {
  MapContent kept{{}, content.spots};
  std::vector<const MapLine*> tested;
  for (const MapLine& l : content.lines) {
    const double level = l.contour ? (l.vertices.front().z() - lowest) / o.interval : 0.0;
    const auto number = static_cast<std::int64_t>(std::llround(level));
    if (!l.contour || number % step == 0)
      kept.lines.push_back(l);
    else if (number % step == step / 2 && std::abs(level - static_cast<double>(number)) < level_rounding)
      tested.push_back(&l);
  }
  OfParts out;
  if (tested.empty() || levels_in(kept).size() < 2) return out;
  MapSurfaceOptions wider = o;
  wider.interval *= step;
  const MapSurface s = map_surface(kept, lattice, wider);
  for (const MapLine* l : tested)
    for (const Eigen::Vector3d& v : l->vertices)
      if (const auto found = read_at(s, v)) {
        Squares& of = out[static_cast<size_t>(found->second)];
        ++of.n, of.sum += (found->first - v.z()) * (found->first - v.z());
      }
  return out;
}

MapError error_of(MapPart part, const MapTerrain& t, const OfParts& second, const OfParts& fourth) {
  const auto p = static_cast<size_t>(part);
  MapError e{std::string(map_part_names[p])};
  e.cells = static_cast<size_t>(std::count(t.surface.part.begin(), t.surface.part.end(), part));
  e.tested = second[p].n, e.every_second = second[p].rms();
  if (fourth[p].n >= fewest_tested) e.every_fourth = fourth[p].rms();
  if (t.levels < 2) return e;
  if (e.tested < fewest_tested) {
    e.sigma = assumed_share * t.interval, e.assumed = true;
    return e;
  }
  const double power = std::isnan(e.every_fourth) ? 1.0 : std::clamp(std::log2(e.every_fourth / e.every_second), 1.0, 2.0);
  e.sigma = e.every_second / std::exp2(power);
  return e;
}

void set_sigma(MapTerrain& t, double own) {
  MapSurface& s = t.surface;
  s.grid.sigma.assign(s.part.size(), std::nanf(""));
  for (size_t c = 0; c < s.part.size(); ++c) {
    if (s.part[c] == MapPart::none) continue;
    const MapError& e = t.errors[static_cast<size_t>(s.part[c]) - 1];
    s.grid.sigma[c] = static_cast<float>(std::hypot(own, *e.sigma * std::max<double>(s.between[c], least_share)));
  }
}

}  // namespace

MapTerrain map_terrain(const MapContent& content, const MapTerrainOptions& o) {
  const core::Lattice lattice = lattice_around(content, o.cell);
  const std::vector<double> levels = levels_in(content);
  MapTerrain out;
  out.levels = levels.size();
  out.interval = o.interval.value_or(usual_step(levels));
  const MapSurfaceOptions surface{out.interval, o.max_edge, o.tolerance, o.keep_flats};
  out.surface = map_surface(content, lattice, surface);
  OfParts second, fourth;
  if (out.levels >= 2) {
    second = errors_without(content, levels.front(), 2, lattice, surface);
    fourth = errors_without(content, levels.front(), 4, lattice, surface);
  }
  for (const MapPart part : {MapPart::between, MapPart::flat, MapPart::kept}) out.errors.push_back(error_of(part, out, second, fourth));
  if (out.levels >= 2) set_sigma(out, o.sigma.value_or(0.0));
  return out;
}

}  // namespace swath::terrain
