// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "report/canvas.h"
#include "report/font.h"
#include "report/map_parts.h"

namespace swath::report {
namespace {

constexpr core::Rgb paper{255, 255, 255}, level_grey{180, 180, 180};
constexpr int margin = 14, text_scale = 2;  // pixels; pixels per dot of the letters
constexpr int narrowest = 760;              // of the whole picture, so that the legend has room
constexpr int enlarged_side = 1000;         // a small grid is enlarged to about this many pixels
constexpr int largest_cell = 16;            // pixels
constexpr double darkest = 0.15;            // brightness of a cell without any light, level ground being 1
constexpr double contrast = 1.4;            // exponent of the brightness: flat country needs more than Lambert's law gives
constexpr double densest = 1.0 / 3.0;       // share of the map that ordinary contours may cover

/// 2nd and 98th percentile of the heights.
Span height_span(const core::Grid& g) {
  std::vector<float> heights;
  for (const float h : g.height)
    if (!std::isnan(h)) heights.push_back(h);
  if (heights.empty()) return {};
  const auto at = [&](double share) {
    const auto k = static_cast<std::ptrdiff_t>(share * static_cast<double>(heights.size() - 1));
    std::nth_element(heights.begin(), heights.begin() + k, heights.end());
    return static_cast<double>(heights[static_cast<size_t>(k)]);
  };
  const double low = at(0.02), high = at(0.98);
  return {low, high, true};
}

/// Tint times brightness, relative to level ground.
std::vector<std::array<float, 3>> ground_colours(const core::Grid& g, const Span& span, const PictureOptions& o) {
  const std::vector<float> shade = hillshade(g.lattice, g.height, o.light);
  const double level = std::max(std::sin(o.light.altitude.value), 0.05);
  std::vector<std::array<float, 3>> out(g.lattice.size());
  for (size_t k = 0; k < out.size(); ++k) {
    if (std::isnan(g.height[k])) continue;
    const double t = span.high > span.low ? (g.height[k] - span.low) / (span.high - span.low) : 0.5;
    const core::Rgb base = o.tint ? tint_of(t) : level_grey;
    const double brightness = darkest + (1.0 - darkest) * std::pow(shade[k] / level, contrast);
    for (size_t c = 0; c < 3; ++c) out[k][c] = static_cast<float>(std::min(255.0, base[c] * brightness));
  }
  return out;
}

/// The cells onto the map, `size` pixels each: voids as they are, ground with soft passages between cells.
void paint_ground(core::Picture& p, const View& view, const core::Grid& g, int size, const std::vector<std::array<float, 3>>& colours) {
  const core::Lattice& l = g.lattice;
  for (int y = 0; y < view.map.height; ++y)
    for (int x = 0; x < view.map.width; ++x) {
      const int i = x / size, j = l.ny - 1 - y / size;
      std::uint8_t* c = p.at(view.map.x + x, view.map.y + y);
      if (std::isnan(g.height[l.at(i, j)])) {
        const core::Rgb v = void_colour(g.reason[l.at(i, j)], x, y);
        std::copy(v.begin(), v.end(), c);
        continue;
      }
      const double u = (x + 0.5) / size - 0.5, v = l.ny - (y + 0.5) / size - 0.5;
      const int i0 = static_cast<int>(std::floor(u)), j0 = static_cast<int>(std::floor(v));
      std::array<double, 3> sum{};
      double weight = 0.0;
      for (int dj = 0; dj <= 1; ++dj)
        for (int di = 0; di <= 1; ++di) {
          if (!l.holds(i0 + di, j0 + dj) || std::isnan(g.height[l.at(i0 + di, j0 + dj)])) continue;
          const double w = (di ? u - i0 : 1 - u + i0) * (dj ? v - j0 : 1 - v + j0);
          for (size_t k = 0; k < 3; ++k) sum[k] += w * static_cast<double>(colours[l.at(i0 + di, j0 + dj)][k]);
          weight += w;
        }
      for (size_t k = 0; k < 3; ++k) c[k] = static_cast<std::uint8_t>(std::lround(sum[k] / weight));
    }
}

std::vector<PixelLine> to_pixels(const std::vector<core::ContourLine>& contours, const View& view) {
  std::vector<PixelLine> out;
  for (const core::ContourLine& c : contours) {
    PixelLine line{{}, {}, c.height, c.index};
    for (size_t k = 0; k < c.x.size(); ++k) {
      line.x.push_back(view.column(c.x[k]));
      line.y.push_back(view.row(c.y[k]));
    }
    out.push_back(std::move(line));
  }
  return out;
}

/// Smallest step between the heights of the lines; 0 where there are fewer than two heights.
double interval_of(const std::vector<PixelLine>& lines, bool index_only) {
  std::vector<double> heights;
  for (const PixelLine& line : lines)
    if (line.index || !index_only) heights.push_back(line.height);
  std::sort(heights.begin(), heights.end());
  double step = 0.0;
  for (size_t k = 1; k < heights.size(); ++k) {
    const double d = heights[k] - heights[k - 1];
    if (d > 1e-6 && (step == 0.0 || d < step)) step = d;
  }
  return step;
}

/// What of the lines is drawn, and their intervals.
void describe_lines(const std::vector<PixelLine>& lines, const Box& map, Shown& shown) {
  double ordinary_length = 0.0;
  for (const PixelLine& line : lines) {
    shown.index = shown.index || line.index;
    if (!line.index) ordinary_length += length_of(line);
  }
  shown.thinned = shown.index && ordinary_length > densest * map.width * map.height;
  shown.ordinary = ordinary_length > 0 && !shown.thinned;
  shown.interval = interval_of(lines, false);
  shown.index_interval = interval_of(lines, true);
}

}  // namespace

core::Grid averaged(const core::Grid& g, int factor) {
  const core::Lattice& l = g.lattice;
  const int f = std::max(factor, 1);
  core::Grid out(core::Lattice{l.cell * f, 0, 0, (l.nx + f - 1) / f, (l.ny + f - 1) / f});
  for (int bj = 0; bj < out.lattice.ny; ++bj)
    for (int bi = 0; bi < out.lattice.nx; ++bi) {
      double sum = 0.0;
      int heights = 0, cells = 0;
      std::array<int, void_reasons> reasons{};
      for (int j = bj * f; j < std::min((bj + 1) * f, l.ny); ++j)
        for (int i = bi * f; i < std::min((bi + 1) * f, l.nx); ++i, ++cells) {
          const size_t k = l.at(i, j);
          if (std::isnan(g.height[k])) {
            ++reasons[static_cast<size_t>(g.reason[k])];
          } else {
            sum += g.height[k];
            ++heights;
          }
        }
      const size_t k = out.lattice.at(bi, bj);
      if (2 * heights >= cells) {
        out.height[k] = static_cast<float>(sum / heights);
        out.reason[k] = core::Void::none;
      } else {
        const auto most = std::max_element(reasons.begin() + 1, reasons.end()) - reasons.begin();
        out.reason[k] = static_cast<core::Void>(most);
      }
    }
  return out;
}

core::Picture relief_picture(const core::Grid& grid, const std::vector<core::ContourLine>& contours, const PictureOptions& o) {
  const core::Lattice& l = grid.lattice;
  if (l.nx <= 0 || l.ny <= 0) return core::Picture();
  const int side = std::max(l.nx, l.ny), limit = std::max(o.max_side, 1);
  const int factor = (side + limit - 1) / limit;
  const core::Grid shown_grid = averaged(grid, factor);
  const int cells = std::max(shown_grid.lattice.nx, shown_grid.lattice.ny);
  const int size = std::clamp(std::min(enlarged_side, limit) / cells, 1, largest_cell);  // pixels per cell

  Shown shown;
  shown.tint = o.tint;
  shown.height_unit = o.height_unit;
  shown.span = height_span(shown_grid);
  for (size_t k = 0; k < shown_grid.height.size(); ++k)
    if (std::isnan(shown_grid.height[k])) shown.voids[static_cast<size_t>(shown_grid.reason[k])] = true;

  View view;
  view.map = {0, o.title.empty() ? margin : margin + (glyph_height + 4) * (text_scale + 1), shown_grid.lattice.nx * size,
              shown_grid.lattice.ny * size};
  const int width = std::max({view.map.width + 2 * margin, text_dots(o.title) * (text_scale + 1) + 2 * margin, narrowest});
  view.map.x = (width - view.map.width) / 2;
  view.west = l.west();
  view.pixel = l.cell * factor / size;
  view.north = l.south() + view.pixel * view.map.height;

  const std::vector<PixelLine> lines = to_pixels(contours, view);
  describe_lines(lines, view.map, shown);

  const int below = view.map.y + view.map.height + margin;
  const int bar_room = margin + std::max(180, view.map.width / 4 + 20), legend_left = bar_room + 60;
  core::Picture unseen;
  const int foot = draw_legend(unseen, legend_left, below, width - margin, text_scale, shown);
  core::Picture p(width, std::max(foot, below + 16 * text_scale) + margin, paper);
  paint_ground(p, view, shown_grid, size, ground_colours(shown_grid, shown.span, o));
  Pen pen(p, view.map);
  if (shown.ordinary)
    for (const PixelLine& line : lines)
      if (!line.index) pen.line(line.x, line.y, 1.0, contour_colour, 0.75);
  for (const PixelLine& line : lines)
    if (line.index) pen.line(line.x, line.y, 2.0, index_colour, 0.9);
  if (o.labels) draw_height_labels(p, lines, view.map, 1.5);
  frame(p, {view.map.x - 1, view.map.y - 1, view.map.width + 2, view.map.height + 2}, ink_colour);

  if (!o.title.empty()) draw_label(p, margin, margin, o.title, text_scale + 1, ink_colour);
  draw_scale_bar(p, view, margin, below, text_scale, o.unit);
  draw_north_arrow(p, bar_room, below, text_scale);
  draw_legend(p, legend_left, below, width - margin, text_scale, shown);
  return p;
}

}  // namespace swath::report
