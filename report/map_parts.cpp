// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/map_parts.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "core/config/units.h"

namespace swath::report {
namespace {

constexpr core::Rgb water{150, 190, 225}, void_light{244, 244, 244}, void_dark{222, 222, 222}, edge_light{247, 238, 238},
    edge_dark{232, 205, 205}, void_rim{120, 120, 120}, halo_colour{250, 246, 232};
constexpr int narrowest = 760;      // so that the legend has room
constexpr int widest_title = 4000;  // a longer one is set smaller
constexpr int tall = 16, part_gap = 8, item_gap = 24, line_step = 28;

/// 1, 2 or 5 times a power of ten, not above `most`.
double round_length(double most) {
  const double power = std::pow(10.0, std::floor(std::log10(most)));
  for (const double k : {5.0, 2.0})
    if (k * power <= most) return k * power;
  return power;
}

}  // namespace

std::string short_number(double v) {
  char text[64];
  auto end = std::to_chars(text, text + sizeof text, v, std::chars_format::fixed, 2).ptr;
  while (end[-1] == '0') --end;
  if (end[-1] == '.') --end;
  const std::string out(text, end);
  return out == "-0" ? "0" : out;
}

core::Rgb tint_of(double t) {
  struct Stop {
    double at;
    std::array<double, 3> colour;
  };
  static constexpr std::array<Stop, 6> stops{{{0.0, {122, 172, 134}},
                                              {0.25, {190, 209, 150}},
                                              {0.5, {242, 230, 178}},
                                              {0.7, {222, 187, 140}},
                                              {0.88, {190, 150, 124}},
                                              {1.0, {236, 230, 226}}}};
  t = std::clamp(t, 0.0, 1.0);
  size_t k = 1;
  while (k + 1 < stops.size() && t > stops[k].at) ++k;
  const double share = (t - stops[k - 1].at) / (stops[k].at - stops[k - 1].at);
  core::Rgb out{};
  for (size_t c = 0; c < 3; ++c)
    out[c] = static_cast<std::uint8_t>(std::lround(stops[k - 1].colour[c] + share * (stops[k].colour[c] - stops[k - 1].colour[c])));
  return out;
}

core::Rgb void_colour(core::Void reason, int x, int y) {
  if (reason == core::Void::water) return water;
  const bool stripe = (x + y) % 10 < 3;
  if (reason == core::Void::long_edge) return stripe ? edge_dark : edge_light;
  if (reason == core::Void::never_seen) return (x - y + 1000000) % 10 < 3 ? edge_dark : void_light;
  return stripe ? void_dark : void_light;
}

MapItem void_item(core::Void reason, const std::string& name) {
  return {"", name, 36, [reason](Canvas& canvas, const Box& b) {
            canvas.pixels(b, [reason](int x, int y) { return void_colour(reason, x, y); });
            canvas.frame(b, void_rim);
          }};
}

MapItem bar_item(const std::string& low, const std::string& high, int width, const std::function<core::Rgb(double)>& colour) {
  return {low, high, width, [colour, width](Canvas& canvas, const Box& b) {
            canvas.pixels(b, [&](int x, int) { return colour(x / (width - 1.0)); });
            canvas.frame(b, ink_colour);
          }};
}

MapItem line_item(const std::string& name, double width, core::Rgb colour) {
  return {"", name, 36, [width, colour](Canvas& canvas, const Box& b) {
            const double y = b.y + b.height / 2.0;
            canvas.line({b.x + 0.0, b.x + b.width + 0.0}, {y, y}, width, colour);
          }};
}

MapLayout::MapLayout(int map_width, int map_height, double pixel, std::string title, std::string unit, std::vector<MapItem> legend)
    : title_(std::move(title)), unit_(std::move(unit)), legend_(std::move(legend)) {
  const auto width_of = [](const std::string& text) { return static_cast<int>(std::ceil(text_width(text, map_text))); };
  const int title_width = static_cast<int>(std::min(std::ceil(text_width(title_, map_title, true)), widest_title + 0.0));
  width = std::max({map_width, title_width, narrowest - 2 * map_margin}) + 2 * map_margin;
  view.pixel = pixel;
  view.map = {(width - map_width) / 2, map_margin + (title_.empty() ? 0 : map_title + 12), map_width, map_height};
  const int below = view.map.y + map_height + map_margin;
  arrow_ = map_margin + std::max(180, map_width / 4 + 20);
  const int left = arrow_ + 60;
  int x = left, y = below;
  for (size_t k = 0; k < legend_.size(); ++k) {
    const MapItem& item = legend_[k];
    const int sample = item.width ? item.width + part_gap : 0, before = item.before.empty() ? 0 : width_of(item.before) + part_gap;
    const int room = before + sample + width_of(item.after);
    if (x > left && x + room > width - map_margin) {
      x = left;
      y += line_step;
    }
    places_.push_back({k, x, y});
    x += room + item_gap;
  }
  height = std::max(y + line_step, below + 40) + map_margin;
}

void MapLayout::draw(Canvas& canvas) const {
  const Box& m = view.map;
  canvas.frame({m.x - 1, m.y - 1, m.width + 2, m.height + 2}, ink_colour);
  canvas.text(map_margin, map_margin + map_title / 2.0, title_,
              {.size = map_title, .colour = ink_colour, .bold = true, .room = width - 2.0 * map_margin});
  const int below = m.y + m.height + map_margin;
  draw_scale_bar(canvas, below);
  draw_north_arrow(canvas, below);
  for (const Place& p : places_) {
    const MapItem& item = legend_[p.item];
    double x = p.x;
    const double y = p.y + tall / 2.0;
    const TextStyle style{.size = map_text, .colour = ink_colour};
    if (!item.before.empty()) {
      canvas.text(x, y, item.before, style);
      x += std::ceil(text_width(item.before, map_text)) + part_gap;
    }
    if (item.width) {
      item.sample(canvas, {static_cast<int>(x), p.y, item.width, tall});
      x += item.width + part_gap;
    }
    canvas.text(x, y, item.after, style);
  }
}

void MapLayout::draw_scale_bar(Canvas& canvas, int top) const {
  const double length = round_length(0.25 * view.map.width * view.pixel);
  const int bar = static_cast<int>(std::lround(length / view.pixel)), thick = 8;
  canvas.frame({map_margin, top, bar, thick}, ink_colour);
  canvas.fill({map_margin, top, bar / 2, thick}, ink_colour);
  const std::string text = unit_ == "m" && length >= 1000 ? short_number(length / 1000) + " km" : short_number(length) + " " + unit_;
  canvas.text(map_margin, top + thick + 8 + map_text / 2.0, text, {.size = map_text, .colour = ink_colour});
}

void MapLayout::draw_north_arrow(Canvas& canvas, int top) const {
  const double x = arrow_ + 10.0, tip = top, foot = top + 24.0;
  canvas.line({x, x}, {foot, tip + 1.0}, 2.4, ink_colour);
  canvas.line({x - 6.0, x, x + 6.0}, {tip + 8.0, tip + 1.0, tip + 8.0}, 2.4, ink_colour);
  canvas.text(x + 14.0, top + 12.0, "N", {.size = map_text, .colour = ink_colour});
}

double length_of(const PixelLine& line) {
  double sum = 0.0;
  for (size_t k = 1; k < line.x.size(); ++k) sum += std::hypot(line.x[k] - line.x[k - 1], line.y[k] - line.y[k - 1]);
  return sum;
}

namespace {

struct Spot {
  double x = 0.0, y = 0.0, angle = 0.0;
};

/// The straightest stretch of `width` pixels along the line that lies inside the map and keeps clear of `taken`.
std::optional<Spot> label_place(const PixelLine& line, double width, double height, const Box& map, const std::vector<Box>& taken) {
  std::vector<double> at{0.0};  // length along the line at each vertex
  for (size_t k = 1; k < line.x.size(); ++k) at.push_back(at.back() + std::hypot(line.x[k] - line.x[k - 1], line.y[k] - line.y[k - 1]));
  if (at.back() < 3.0 * width) return std::nullopt;
  const auto point = [&](double s) {
    const auto k = static_cast<size_t>(
        std::clamp<std::ptrdiff_t>(std::upper_bound(at.begin(), at.end(), s) - at.begin(), 1, static_cast<std::ptrdiff_t>(at.size()) - 1));
    const double step = at[k] - at[k - 1];
    const double share = step > 0 ? (s - at[k - 1]) / step : 0.0;
    return Spot{line.x[k - 1] + share * (line.x[k] - line.x[k - 1]), line.y[k - 1] + share * (line.y[k] - line.y[k - 1]), 0.0};
  };
  std::optional<Spot> best;
  double straightest = 0.85;  // chord over arc; a bend stronger than this carries no label
  constexpr int tries = 24;
  for (int n = 0; n < tries; ++n) {
    const double s = width + (at.back() - 2.0 * width) * (n + 0.5) / tries;
    const Spot a = point(s - width / 2), b = point(s + width / 2), middle = point(s);
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
    best = Spot{(a.x + b.x + 2 * middle.x) / 4, (a.y + b.y + 2 * middle.y) / 4, angle};
  }
  return best;
}

}  // namespace

void draw_height_labels(Canvas& canvas, const std::vector<PixelLine>& lines, const Box& map) {
  constexpr double size = 13.0;
  std::vector<std::pair<double, size_t>> order;
  for (size_t k = 0; k < lines.size(); ++k)
    if (lines[k].index) order.emplace_back(-length_of(lines[k]), k);
  std::sort(order.begin(), order.end());
  std::vector<Box> taken;
  for (const auto& [length, k] : order) {
    const std::string text = short_number(lines[k].height);
    const double width = text_width(text, size) + 6.0;
    const auto place = label_place(lines[k], width, size, map, taken);
    if (!place) continue;
    canvas.text(place->x, place->y, text,
                {.size = size, .colour = index_colour, .anchor = Anchor::middle, .angle = place->angle, .halo = halo_colour});
    const int half = static_cast<int>(std::ceil(width));
    taken.push_back({static_cast<int>(place->x) - half, static_cast<int>(place->y) - half, 2 * half, 2 * half});
  }
}

}  // namespace swath::report
