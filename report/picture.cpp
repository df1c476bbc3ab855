// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "core/statistics.h"
#include "report/map_parts.h"

namespace swath::report {
namespace {

constexpr core::Rgb level_grey{180, 180, 180};
constexpr int enlarged_side = 1000;                    // a small grid is enlarged to about this many pixels
constexpr double legend_step = 0.1;                    // of the legend's heights
constexpr double darkest = 0.15;                       // brightness of a cell without any light, level ground being 1
constexpr double contrast = 1.4;                       // exponent of the brightness: flat country needs more than Lambert's law gives
constexpr double densest = 1.0 / 3.0;                  // share of the map that ordinary contours may cover
constexpr double ordinary_gap = 3.0, index_gap = 4.0;  // pixels from line to line at least, lines of 1 and 2 pixels

/// 2nd and 98th percentile of the heights: single peaks and pits do not take the colours from the rest.
Span height_span(const core::Grid& g) {
  std::vector<double> heights;
  for (const float h : g.height)
    if (!std::isnan(h)) heights.push_back(static_cast<double>(h));
  if (heights.empty()) return {};
  return {core::quantile(heights, 0.02), core::quantile(heights, 0.98), true};
}

/// Tint times brightness, relative to level ground.
std::vector<std::array<float, 3>> ground_colours(const core::Grid& g, const Span& span, const PictureOptions& o) {
  const std::vector<float> shade = core::hillshade(g, g.lattice, o.light).height;
  const double level = std::max(std::sin(o.light.altitude.value), 0.05);
  std::vector<std::array<float, 3>> out(g.lattice.size());
  for (size_t k = 0; k < out.size(); ++k) {
    if (std::isnan(g.height[k])) continue;
    const double t = span.high > span.low ? (g.height[k] - span.low) / (span.high - span.low) : 0.5;
    const core::Rgb base = o.tint ? tint_of(t) : level_grey;
    const double brightness = darkest + (1.0 - darkest) * std::pow(shade[k] / 255.0 / level, contrast);
    for (size_t c = 0; c < 3; ++c) out[k][c] = static_cast<float>(std::min(255.0, base[c] * brightness));
  }
  return out;
}

/// The ground of a map, `size` pixels per cell: voids as they are, ground with soft passages between cells.
struct Ground {
  core::Grid grid;
  int size;
  std::vector<std::array<float, 3>> colours;

  /// Rise per pixel over some cells around a place on the map, in pixels; 0 where it is not known.
  double rise(double x, double y) const {
    const core::Lattice& l = grid.lattice;
    const int i = static_cast<int>(std::floor(x / size)), j = l.ny - 1 - static_cast<int>(std::floor(y / size));
    const int reach = std::max(1, 4 / size);
    const auto along = [&](int di, int dj) {
      const int west = std::max(i - di, 0), east = std::min(i + di, l.nx - 1), south = std::max(j - dj, 0),
                north = std::min(j + dj, l.ny - 1);
      const int cells = east - west + north - south;
      if (cells <= 0) return 0.0;
      const double d = static_cast<double>(grid.height[l.at(east, north)]) - static_cast<double>(grid.height[l.at(west, south)]);
      return std::isnan(d) ? 0.0 : d / (cells * size);
    };
    return l.holds(i, j) ? std::hypot(along(reach, 0), along(0, reach)) : 0.0;
  }

  core::Rgb at(int x, int y) const {
    const core::Lattice& l = grid.lattice;
    if (const size_t k = l.at(x / size, l.ny - 1 - y / size); std::isnan(grid.height[k])) return void_colour(grid.reason[k], x, y);
    const double u = (x + 0.5) / size - 0.5, v = l.ny - (y + 0.5) / size - 0.5;
    const int i0 = static_cast<int>(std::floor(u)), j0 = static_cast<int>(std::floor(v));
    std::array<double, 3> sum{};
    double weight = 0.0;
    for (int dj = 0; dj <= 1; ++dj)
      for (int di = 0; di <= 1; ++di) {
        if (!l.holds(i0 + di, j0 + dj) || std::isnan(grid.height[l.at(i0 + di, j0 + dj)])) continue;
        const double w = (di ? u - i0 : 1 - u + i0) * (dj ? v - j0 : 1 - v + j0);
        for (size_t k = 0; k < 3; ++k) sum[k] += w * static_cast<double>(colours[l.at(i0 + di, j0 + dj)][k]);
        weight += w;
      }
    core::Rgb out{};
    for (size_t k = 0; k < 3; ++k) out[k] = static_cast<std::uint8_t>(std::lround(sum[k] / weight));
    return out;
  }
};

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

/// Of the heights that are drawn where lines come near: the interval of those that hold this one; 0 where it is the only one.
double step_of(const PixelLine& line, double interval, double index_interval) {
  if (!line.index) return interval;
  for (const double several : {20.0, 10.0, 4.0, 2.0}) {
    if (index_interval <= 0.0) break;
    const double times = line.height / (several * index_interval);
    if (std::abs(times - std::round(times)) < 1e-6) return several * index_interval;
  }
  return index_interval;
}

/// Without the parts on ground so steep that lines of their step would touch: there index contours alone are left, or every second ...
std::vector<PixelLine> apart_on_slopes(const std::vector<PixelLine>& lines, const Ground& ground, const Box& map) {
  const double interval = interval_of(lines, false), index_interval = interval_of(lines, true);
  std::vector<PixelLine> out;
  for (const PixelLine& line : lines) {
    const double step = step_of(line, interval, index_interval), gap = line.index ? index_gap : ordinary_gap;
    PixelLine part{{}, {}, line.height, line.index};
    const auto end = [&] {
      if (part.x.size() > 1) out.push_back(part);
      part.x.clear(), part.y.clear();
    };
    for (size_t k = 0; k < line.x.size(); ++k) {
      const double back = k > 0 ? 0.5 : 0.0;  // the middle of the stretch from the vertex before
      const size_t before = k > 0 ? k - 1 : 0;
      const double x = line.x[k] + back * (line.x[before] - line.x[k]), y = line.y[k] + back * (line.y[before] - line.y[k]);
      if (step > 0.0 && ground.rise(x - map.x, y - map.y) * gap > step) end();
      part.x.push_back(line.x[k]);
      part.y.push_back(line.y[k]);
    }
    end();
  }
  return out;
}

/// What of the lines is drawn, and their intervals.
struct Shown {
  bool ordinary = false, index = false, thinned = false;
  double interval = 0.0, index_interval = 0.0;
};

Shown shown_of(const std::vector<PixelLine>& lines, double map_pixels) {
  Shown shown;
  double ordinary_length = 0.0;
  for (const PixelLine& line : lines) {
    shown.index = shown.index || line.index;
    if (!line.index) ordinary_length += length_of(line);
  }
  shown.thinned = shown.index && ordinary_length > densest * map_pixels;
  shown.ordinary = ordinary_length > 0 && !shown.thinned;
  shown.interval = interval_of(lines, false);
  shown.index_interval = interval_of(lines, true);
  return shown;
}

std::vector<MapItem> legend_of(const core::Grid& g, const Span& span, const Shown& shown, const PictureOptions& o) {
  std::vector<MapItem> out;
  const auto rounded = [](double v) { return short_number(std::round(v * 10.0) / 10.0); };
  const auto beyond = [&](const auto& is) { return std::any_of(g.height.begin(), g.height.end(), is); };
  const char* below = beyond([&](float h) { return static_cast<double>(h) < span.low - legend_step; }) ? "< " : "";
  const char* above = beyond([&](float h) { return static_cast<double>(h) > span.high + legend_step; }) ? "> " : "";
  if (span.any && o.tint)
    out.push_back(bar_item(below + rounded(span.low), above + rounded(span.high) + " " + o.height_unit, 140, tint_of));
  const auto every = [&](const char* what, double step) {
    return step > 0 ? std::string(what) + " " + short_number(step) + " " + o.height_unit : std::string(what);
  };
  if (shown.ordinary) out.push_back(line_item(every("contours", shown.interval), 2.0, contour_colour));
  if (shown.index)
    out.push_back(line_item(every(shown.thinned ? "index contours only" : "index contours", shown.index_interval), 4.0, index_colour));
  std::array<bool, void_reasons> voids{};
  for (size_t k = 0; k < g.height.size(); ++k)
    if (std::isnan(g.height[k])) voids[static_cast<size_t>(g.reason[k])] = true;
  static constexpr std::array<const char*, void_reasons> names{"", "no data", "too far from ground points", "water", "never seen"};
  for (size_t v = 1; v < names.size(); ++v)
    if (voids[v]) out.push_back(void_item(static_cast<core::Void>(v), names[v]));
  return out;
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

Drawing relief_map(const core::Grid& grid, const std::vector<core::ContourLine>& contours, const PictureOptions& o) {
  const core::Lattice& l = grid.lattice;
  if (l.nx <= 0 || l.ny <= 0) return {};
  const int side = std::max(l.nx, l.ny), limit = std::max(o.max_side, 1);
  const int factor = (side + limit - 1) / limit;
  auto ground = std::make_shared<Ground>();
  ground->grid = averaged(grid, factor);
  const core::Lattice& shown_lattice = ground->grid.lattice;
  const int cells = std::max(shown_lattice.nx, shown_lattice.ny);
  ground->size = std::clamp(std::min(enlarged_side, limit) / cells, 1, largest_cell);
  const Span span = height_span(ground->grid);
  ground->colours = ground_colours(ground->grid, span, o);

  const int map_width = shown_lattice.nx * ground->size, map_height = shown_lattice.ny * ground->size;
  View view;  // the lines' lengths do not depend on the map's place
  view.pixel = l.cell * factor / ground->size;
  view.west = l.west();
  view.north = l.south() + view.pixel * map_height;
  const Shown shown = shown_of(to_pixels(contours, view), static_cast<double>(map_width) * map_height);
  auto layout = std::make_shared<MapLayout>(map_width, map_height, view.pixel, o.title, o.unit, legend_of(ground->grid, span, shown, o));
  layout->view.west = view.west;
  layout->view.north = view.north;
  return {layout->width, layout->height,
          [ground, layout, shown, labels = o.labels,
           lines = apart_on_slopes(to_pixels(contours, layout->view), *ground, layout->view.map)](Canvas& canvas) {
            const Box& map = layout->view.map;
            canvas.pixels(map, [&](int x, int y) { return ground->at(x, y); });
            canvas.clip(map);
            if (shown.ordinary)
              for (const PixelLine& line : lines)
                if (!line.index) canvas.line(line.x, line.y, 1.0, contour_colour, 0.75);
            for (const PixelLine& line : lines)
              if (line.index) canvas.line(line.x, line.y, 2.0, index_colour, 0.9);
            if (labels) draw_height_labels(canvas, lines, map);
            canvas.clip(std::nullopt);
            layout->draw(canvas);
          }};
}

}  // namespace swath::report
