// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/map_parts.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "report/font.h"

namespace swath::report {
namespace {

constexpr core::Rgb water{150, 190, 225}, void_light{244, 244, 244}, void_dark{222, 222, 222}, edge_light{247, 238, 238},
    edge_dark{232, 205, 205};

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

void draw_scale_bar(core::Picture& p, const View& view, int left, int top, int scale, const std::string& unit) {
  const double length = round_length(0.25 * view.map.width * view.pixel);
  const int bar = static_cast<int>(std::lround(length / view.pixel)), thick = 4 * scale;
  frame(p, {left, top, bar, thick}, ink_colour);
  fill(p, {left, top, bar / 2, thick}, ink_colour);
  const std::string text = unit == "m" && length >= 1000 ? short_number(length / 1000) + " km" : short_number(length) + " " + unit;
  draw_label(p, left, top + thick + 3 * scale, text, scale, ink_colour);
}

void draw_north_arrow(core::Picture& p, int left, int top, int scale) {
  const double x = left + 5.0 * scale, tip = top, foot = top + 12.0 * scale;
  Pen pen(p, {0, 0, p.width, p.height});
  pen.line({x, x}, {foot, tip}, 1.2 * scale, ink_colour);
  pen.line({x - 3.0 * scale, x, x + 3.0 * scale}, {tip + 4.0 * scale, tip, tip + 4.0 * scale}, 1.2 * scale, ink_colour);
  draw_text(p, x + 9.0 * scale, top + 6.0 * scale, "N", scale, 0.0, ink_colour);
}

int draw_legend(core::Picture& p, int left, int top, int right, int scale, const Shown& shown) {
  int x = left, y = top;
  const int sample = 18 * scale, tall = 8 * scale, gap = 12 * scale, line_step = 14 * scale;
  const auto room_for = [&](int width) {
    if (x > left && x + width > right) {
      x = left;
      y += line_step;
    }
  };
  if (shown.span.any && shown.tint) {
    const std::string low = short_number(std::round(shown.span.low * 10) / 10),
                      high = short_number(std::round(shown.span.high * 10) / 10) + " " + shown.height_unit;
    const int bar = 70 * scale;
    room_for((text_dots(low) + text_dots(high) + 8) * scale + bar);
    x += draw_label(p, x, y, low, scale, ink_colour) + 4 * scale;
    for (int k = 0; k < bar; ++k) fill(p, {x + k, y, 1, tall}, tint_of(k / (bar - 1.0)));
    frame(p, {x, y, bar, tall}, ink_colour);
    x += bar + 4 * scale;
    x += draw_label(p, x, y, high, scale, ink_colour) + gap;
  }
  const auto entry = [&](const std::string& text, auto&& draw) {
    room_for(sample + 4 * scale + text_dots(text) * scale);
    draw(Box{x, y, sample, tall});
    x += sample + 4 * scale;
    x += draw_label(p, x, y, text, scale, ink_colour) + gap;
  };
  Pen pen(p, {0, 0, p.width, p.height});
  const auto rule = [&](double width, core::Rgb colour) {
    return [&pen, width, colour](const Box& b) {
      pen.line({b.x + 0.0, b.x + b.width + 0.0}, {b.y + b.height / 2.0, b.y + b.height / 2.0}, width, colour);
    };
  };
  const auto every = [&](const char* what, double step) {
    return step > 0 ? std::string(what) + " " + short_number(step) + " " + shown.height_unit : std::string(what);
  };
  if (shown.ordinary) entry(every("contours", shown.interval), rule(scale, contour_colour));
  if (shown.index)
    entry(every(shown.thinned ? "index contours only" : "index contours", shown.index_interval), rule(2.0 * scale, index_colour));
  static constexpr std::array<const char*, void_reasons> names{"", "no data", "edge too long", "water", "never seen"};
  for (size_t v = 1; v < names.size(); ++v)
    if (shown.voids[v])
      entry(names[v], [&](const Box& b) {
        for (int dy = 0; dy < b.height; ++dy)
          for (int dx = 0; dx < b.width; ++dx) mix(p, b.x + dx, b.y + dy, void_colour(static_cast<core::Void>(v), dx, dy), 1.0);
        frame(p, b, {120, 120, 120});
      });
  return y + line_step;
}

}  // namespace swath::report
