// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/map_parts.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/units.h"
#include "report/font.h"

namespace swath::report {

double length_of(const PixelLine& line) {
  double sum = 0.0;
  for (size_t k = 1; k < line.x.size(); ++k) sum += std::hypot(line.x[k] - line.x[k - 1], line.y[k] - line.y[k - 1]);
  return sum;
}

namespace {

struct Place {
  double x = 0.0, y = 0.0, angle = 0.0;
};

/// The straightest stretch of `width` pixels along the line that lies inside the map and keeps clear of `taken`.
std::optional<Place> label_place(const PixelLine& line, double width, double height, const Box& map, const std::vector<Box>& taken) {
  std::vector<double> at{0.0};  // length along the line at each vertex
  for (size_t k = 1; k < line.x.size(); ++k) at.push_back(at.back() + std::hypot(line.x[k] - line.x[k - 1], line.y[k] - line.y[k - 1]));
  if (at.back() < 3.0 * width) return std::nullopt;
  const auto point = [&](double s) {
    const auto k = static_cast<size_t>(
        std::clamp<std::ptrdiff_t>(std::upper_bound(at.begin(), at.end(), s) - at.begin(), 1, static_cast<std::ptrdiff_t>(at.size()) - 1));
    const double step = at[k] - at[k - 1];
    const double share = step > 0 ? (s - at[k - 1]) / step : 0.0;
    return Place{line.x[k - 1] + share * (line.x[k] - line.x[k - 1]), line.y[k - 1] + share * (line.y[k] - line.y[k - 1]), 0.0};
  };
  std::optional<Place> best;
  double straightest = 0.85;  // chord over arc; a bend stronger than this carries no label
  constexpr int tries = 24;
  for (int n = 0; n < tries; ++n) {
    const double s = width + (at.back() - 2.0 * width) * (n + 0.5) / tries;
    const Place a = point(s - width / 2), b = point(s + width / 2), middle = point(s);
    const double straight = std::hypot(b.x - a.x, b.y - a.y) / width;
    const int half = static_cast<int>(std::ceil(std::hypot(width, height) / 2));
    const Box box{static_cast<int>(middle.x) - half, static_cast<int>(middle.y) - half, 2 * half, 2 * half};
    const bool inside = box.x > map.x && box.y > map.y && box.x + box.width < map.x + map.width && box.y + box.height < map.y + map.height;
    if (!inside || straight <= straightest + 1e-9) continue;
    if (std::any_of(taken.begin(), taken.end(), [&](const Box& t) { return t.overlaps(box); })) continue;
    straightest = straight;
    double angle = std::atan2(b.y - a.y, b.x - a.x);
    if (angle > core::pi / 2) angle -= core::pi;
    if (angle <= -core::pi / 2) angle += core::pi;
    best = Place{(a.x + b.x + 2 * middle.x) / 4, (a.y + b.y + 2 * middle.y) / 4, angle};
  }
  return best;
}

}  // namespace

void draw_height_labels(core::Picture& p, const std::vector<PixelLine>& lines, const Box& map, double scale) {
  std::vector<std::pair<double, size_t>> order;
  for (size_t k = 0; k < lines.size(); ++k)
    if (lines[k].index) order.emplace_back(-length_of(lines[k]), k);
  std::sort(order.begin(), order.end());
  std::vector<Box> taken;
  for (const auto& [length, k] : order) {
    const std::string text = short_number(lines[k].height);
    const double width = text_dots(text) * scale + 4 * scale, height = (glyph_height + 2) * scale;
    const auto place = label_place(lines[k], width, height, map, taken);
    if (!place) continue;
    draw_text(p, place->x, place->y, text, scale, place->angle, index_colour, core::Rgb{250, 246, 232});
    const int half = static_cast<int>(std::ceil(width));
    taken.push_back({static_cast<int>(place->x) - half, static_cast<int>(place->y) - half, 2 * half, 2 * half});
  }
}

}  // namespace swath::report
