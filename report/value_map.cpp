// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/value_map.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "core/statistics.h"
#include "report/map_parts.h"
#include "report/picture.h"

namespace swath::report {
namespace {

constexpr double low_share = 0.02, high_share = 0.98;

/// White to dark blue over green, t from 0 to 1.
core::Rgb sequential_colour(double t) {
  constexpr core::Rgb pale{247, 252, 240}, green{123, 204, 196}, dark{8, 64, 129};
  const double at = std::clamp(t, 0.0, 1.0);
  const core::Rgb &from = at < 0.5 ? pale : green, &to = at < 0.5 ? green : dark;
  const double share = at < 0.5 ? 2.0 * at : 2.0 * at - 1.0;
  core::Rgb out{};
  for (size_t c = 0; c < 3; ++c) out[c] = static_cast<std::uint8_t>(std::lround(from[c] + share * (to[c] - from[c])));
  return out;
}

std::pair<double, double> range_of(const std::vector<float>& values, const ValueMapOptions& o) {
  if (o.high > o.low) return {o.low, o.high};
  std::vector<double> known;
  for (const float v : values)
    if (std::isfinite(v)) known.push_back(static_cast<double>(v));
  const double low = core::quantile(known, low_share, 0.0), high = core::quantile(known, high_share, 1.0);
  return {low, high > low ? high : low + std::max(1e-6, 0.01 * std::abs(low))};
}

void draw_lines(Canvas& canvas, const View& view, const std::vector<MapLine>& lines) {
  canvas.clip(view.map);
  for (const MapLine& l : lines) {
    std::vector<double> x, y;
    for (size_t k = 0; k < l.x.size(); ++k) {
      x.push_back(view.column(l.x[k]));
      y.push_back(view.row(l.y[k]));
    }
    canvas.line(x, y, l.width, ink_colour);
    TextStyle style;
    style.size = 12;
    style.halo = core::Rgb{255, 255, 255};
    if (!l.name.empty() && !x.empty())
      canvas.text(std::clamp(x[0], view.map.x + 4.0, view.map.x + view.map.width - 40.0),
                  std::clamp(y[0], view.map.y + 10.0, view.map.y + view.map.height - 10.0), l.name, style);
  }
  canvas.clip({});
}

}  // namespace

Drawing value_map(const core::Lattice& l, const std::vector<float>& values, const std::vector<MapLine>& lines, const ValueMapOptions& o) {
  if (l.nx <= 0 || l.ny <= 0) return {};
  core::Grid grid(l);
  for (size_t k = 0; k < values.size(); ++k) {
    grid.height[k] = values[k];
    if (std::isfinite(values[k])) grid.reason[k] = core::Void::none;
  }
  const int side = std::max(l.nx, l.ny), limit = std::max(o.max_side, 1), factor = (side + limit - 1) / limit;
  const auto shown = std::make_shared<const core::Grid>(averaged(grid, factor));
  const int nx = shown->lattice.nx, ny = shown->lattice.ny, size = std::clamp(limit / std::max(nx, ny), 1, largest_cell);
  const auto [low, high] = range_of(values, o);
  std::vector<MapItem> legend{bar_item(short_number(low), short_number(high) + (o.value_unit.empty() ? "" : " " + o.value_unit), 181,
                                       [](double t) { return sequential_colour(t); })};
  if (std::any_of(values.begin(), values.end(), [](float v) { return !std::isfinite(v); }))
    legend.push_back(void_item(core::Void::no_data, o.void_name));
  const double pixel = l.cell * factor / size;
  const auto layout = std::make_shared<MapLayout>(nx * size, ny * size, pixel, o.title, o.unit, legend);
  layout->view.west = l.west();
  layout->view.north = l.south() + pixel * ny * size;
  layout->view.pixel = pixel;
  return {layout->width, layout->height, [shown, layout, lines, size, low = low, high = high](Canvas& canvas) {
            canvas.pixels(layout->view.map, [&](int x, int y) {
              const core::Lattice& cells = shown->lattice;
              const float v = shown->height[cells.at(x / size, cells.ny - 1 - y / size)];
              return std::isfinite(v) ? sequential_colour((static_cast<double>(v) - low) / (high - low))
                                      : void_colour(core::Void::no_data, x, y);
            });
            draw_lines(canvas, layout->view, lines);
            layout->draw(canvas);
          }};
}

}  // namespace swath::report
