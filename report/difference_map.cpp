// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/difference_map.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "core/statistics.h"
#include "report/map_parts.h"
#include "report/picture.h"

namespace swath::report {
namespace {

constexpr double shown_share = 0.98, least_range = 0.001;

/// 1, 2 or 5 times a power of ten, at least `v`.
double round_up(double v) {
  constexpr double rounding = 1e-6;  // differences are floats
  const double power = std::pow(10.0, std::floor(std::log10(v)));
  for (const double k : {1.0, 2.0, 5.0})
    if (k * power >= v * (1.0 - rounding)) return k * power;
  return 10.0 * power;
}

std::vector<double> sizes(const core::Grid& g) {
  std::vector<double> out;
  for (const float h : g.height)
    if (std::isfinite(h)) out.push_back(std::abs(static_cast<double>(h)));
  return out;
}

std::vector<MapItem> legend_of(const core::Grid& g, double range) {
  const bool fine = range < 1.0;
  const std::string unit = fine ? " cm" : " m", end = short_number(range * (fine ? 100.0 : 1.0));
  MapItem bar = bar_item("-" + end, "+" + end + unit, 181, [](double t) { return diverging_colour(2.0 * t - 1.0); });
  bar.sample = [draw = bar.sample](Canvas& canvas, const Box& b) {
    draw(canvas, b);
    canvas.fill({b.x + b.width / 2, b.y, 1, b.height}, ink_colour);
  };
  std::vector<MapItem> out{bar};
  const std::vector<double> values = sizes(g);
  const auto n = std::count_if(values.begin(), values.end(), [&](double v) { return v > range; });
  const double percent = values.empty() ? 0.0 : 100.0 * static_cast<double>(n) / static_cast<double>(values.size());
  if (n > 0) out.push_back({"", (percent < 0.01 ? "< 0.01" : short_number(percent)) + " % beyond", 0});
  if (values.size() < g.height.size()) out.push_back(void_item(core::Void::no_data, "no difference"));
  return out;
}

}  // namespace

core::Rgb diverging_colour(double t) {
  constexpr core::Rgb blue{33, 102, 172}, pale_blue{146, 197, 222}, white{250, 250, 250}, pale_red{244, 165, 130}, red{178, 24, 43};
  if (!std::isfinite(t)) return white;
  const double size = std::min(std::abs(t), 1.0);
  const core::Rgb &middle = t < 0 ? pale_blue : pale_red, &end = t < 0 ? blue : red;
  const bool near = size < 0.5;
  const core::Rgb &from = near ? white : middle, &to = near ? middle : end;
  const double share = near ? 2.0 * size : 2.0 * size - 1.0;
  core::Rgb out{};
  for (size_t c = 0; c < 3; ++c) out[c] = static_cast<std::uint8_t>(std::lround(from[c] + share * (to[c] - from[c])));
  return out;
}

double difference_range(const core::Grid& grid) {
  return round_up(std::max(core::quantile(sizes(grid), shown_share, least_range), least_range));
}

Drawing difference_map(const core::Grid& grid, const DifferenceMapOptions& o) {
  const core::Lattice& l = grid.lattice;
  if (l.nx <= 0 || l.ny <= 0) return {};
  const int side = std::max(l.nx, l.ny), limit = std::max(o.max_side, 1), factor = (side + limit - 1) / limit;
  const auto shown = std::make_shared<const core::Grid>(averaged(grid, factor));
  const int nx = shown->lattice.nx, ny = shown->lattice.ny, size = std::clamp(limit / std::max(nx, ny), 1, largest_cell);
  const double range = o.range > 0 ? o.range : difference_range(grid);
  const auto layout =
      std::make_shared<const MapLayout>(nx * size, ny * size, l.cell * factor / size, o.title, o.unit, legend_of(grid, range));
  return {layout->width, layout->height, [shown, layout, range, size](Canvas& canvas) {
            canvas.pixels(layout->view.map, [&](int x, int y) {
              const core::Lattice& cells = shown->lattice;
              const float h = shown->height[cells.at(x / size, cells.ny - 1 - y / size)];
              return std::isfinite(h) ? diverging_colour(static_cast<double>(h) / range) : void_colour(core::Void::no_data, x, y);
            });
            layout->draw(canvas);
          }};
}

}  // namespace swath::report
