// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/difference_map.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/statistics.h"
#include "report/canvas.h"
#include "report/font.h"
#include "report/map_parts.h"
#include "report/picture.h"

namespace swath::report {
namespace {

constexpr double shown_share = 0.98, least_range = 0.001;
constexpr int margin = 14, text_scale = 2, narrowest = 760, largest_cell = 16;

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

struct Legend {
  double range = 0.0;
  std::string beyond;  ///< empty: nothing is
  bool voids = false;
};

Legend legend_of(const core::Grid& g, double range) {
  Legend out{range, {}, false};
  const std::vector<double> values = sizes(g);
  const auto n = std::count_if(values.begin(), values.end(), [&](double v) { return v > range; });
  const double percent = values.empty() ? 0.0 : 100.0 * static_cast<double>(n) / static_cast<double>(values.size());
  if (n > 0) out.beyond = (percent < 0.01 ? "< 0.01" : short_number(percent)) + " % beyond";
  out.voids = values.size() < g.height.size();
  return out;
}

/// Returns the row below the last line; on an empty picture it only measures.
int draw_difference_legend(core::Picture& p, int left, int top, int right, const Legend& legend) {
  constexpr int bar = 90 * text_scale, tall = 8 * text_scale, sample = 18 * text_scale, line_step = 14 * text_scale, gap = 12 * text_scale;
  const bool fine = legend.range < 1.0;
  const std::string unit = fine ? " cm" : " m", end = short_number(legend.range * (fine ? 100.0 : 1.0));
  int x = left, y = top;
  const auto room_for = [&](int width) {
    if (x == left || x + width <= right) return;
    x = left;
    y += line_step;
  };
  const auto label = [&](const std::string& text) { return draw_label(p, x, y, text, text_scale, ink_colour); };
  x += label("-" + end) + 4 * text_scale;
  for (int k = 0; k < bar; ++k) fill(p, {x + k, y, 1, tall}, diverging_colour(2.0 * k / (bar - 1.0) - 1.0));
  frame(p, {x, y, bar, tall}, ink_colour);
  fill(p, {x + bar / 2, y, 1, tall}, ink_colour);
  x += bar + 4 * text_scale;
  x += label("+" + end + unit) + gap;
  if (!legend.beyond.empty()) {
    room_for(text_dots(legend.beyond) * text_scale);
    x += label(legend.beyond) + gap;
  }
  if (legend.voids) {
    const std::string text = "no difference";
    room_for(sample + (4 + text_dots(text)) * text_scale);
    for (int dy = 0; dy < tall; ++dy)
      for (int dx = 0; dx < sample; ++dx) mix(p, x + dx, y + dy, void_colour(core::Void::no_data, dx, dy), 1.0);
    frame(p, {x, y, sample, tall}, {120, 120, 120});
    x += sample + 4 * text_scale;
    label(text);
  }
  return y + line_step;
}

/// Title at a size that has room.
int title_scale(const std::string& title, int width) {
  for (int scale = text_scale + 1; scale > 1; --scale)
    if (text_dots(title) * scale + 2 * margin <= width) return scale;
  return 1;
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

core::Picture difference_picture(const core::Grid& grid, const DifferenceMapOptions& o) {
  const core::Lattice& l = grid.lattice;
  if (l.nx <= 0 || l.ny <= 0) return core::Picture();
  const int side = std::max(l.nx, l.ny), limit = std::max(o.max_side, 1), factor = (side + limit - 1) / limit;
  const core::Grid shown = averaged(grid, factor);
  const int size = std::clamp(limit / std::max(shown.lattice.nx, shown.lattice.ny), 1, largest_cell);
  const double range = o.range > 0 ? o.range : difference_range(grid);
  const Legend legend = legend_of(grid, range);

  View view;
  view.map.width = shown.lattice.nx * size;
  view.map.height = shown.lattice.ny * size;
  const int width = std::max(view.map.width + 2 * margin, narrowest), scale = title_scale(o.title, width);
  view.map.x = (width - view.map.width) / 2;
  view.map.y = margin + (o.title.empty() ? 0 : (glyph_height + 4) * scale);
  view.pixel = l.cell * factor / size;

  const int below = view.map.y + view.map.height + margin, bar_room = margin + std::max(180, view.map.width / 4 + 20);
  const int legend_left = bar_room + 60;
  core::Picture unseen;
  const int foot = draw_difference_legend(unseen, legend_left, below, width - margin, legend);
  core::Picture p(width, std::max(foot, below + 16 * text_scale) + margin);
  for (int y = 0; y < view.map.height; ++y)
    for (int x = 0; x < view.map.width; ++x) {
      const float h = shown.height[shown.lattice.at(x / size, shown.lattice.ny - 1 - y / size)];
      const core::Rgb c = std::isfinite(h) ? diverging_colour(static_cast<double>(h) / range) : void_colour(core::Void::no_data, x, y);
      std::copy(c.begin(), c.end(), p.at(view.map.x + x, view.map.y + y));
    }
  frame(p, {view.map.x - 1, view.map.y - 1, view.map.width + 2, view.map.height + 2}, ink_colour);
  if (!o.title.empty()) draw_label(p, margin, margin, o.title, scale, ink_colour);
  draw_scale_bar(p, view, margin, below, text_scale, o.unit);
  draw_north_arrow(p, bar_room, below, text_scale);
  draw_difference_legend(p, legend_left, below, width - margin, legend);
  return p;
}

}  // namespace swath::report
