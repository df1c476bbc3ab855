// SPDX-License-Identifier: GPL-3.0-or-later
// A line covers of a pixel what the strip of its width, laid through the line's nearest point, cuts out of the pixel's square: exact along
// a straight line; at ends and bends an end is taken as round, at most a few hundredths of a pixel wrong.
#include "report/canvas.h"

#include <algorithm>
#include <cmath>

#include "report/font.h"

namespace swath::report {

void mix(core::Picture& p, int x, int y, core::Rgb colour, double share) {
  if (!p.holds(x, y) || share <= 0.0) return;
  std::uint8_t* c = p.at(x, y);
  for (size_t k = 0; k < 3; ++k) c[k] = static_cast<std::uint8_t>(std::lround(c[k] + std::min(share, 1.0) * (colour[k] - c[k])));
}

void fill(core::Picture& p, const Box& b, core::Rgb colour) {
  for (int y = b.y; y < b.y + b.height; ++y)
    for (int x = b.x; x < b.x + b.width; ++x) mix(p, x, y, colour, 1.0);
}

void frame(core::Picture& p, const Box& b, core::Rgb colour) {
  fill(p, {b.x, b.y, b.width, 1}, colour);
  fill(p, {b.x, b.y + b.height - 1, b.width, 1}, colour);
  fill(p, {b.x, b.y, 1, b.height}, colour);
  fill(p, {b.x + b.width - 1, b.y, 1, b.height}, colour);
}

Pen::Pen(core::Picture& p, const Box& clip)
    : picture_(&p), clip_(clip), share_(static_cast<size_t>(clip.width) * static_cast<size_t>(clip.height), 0.0f) {}

namespace {

/// The part of a unit square around the origin that lies below distance t along the unit normal (nx, ny).
double square_below(double t, double nx, double ny) {
  const double a = std::max(std::abs(nx), std::abs(ny)), b = std::min(std::abs(nx), std::abs(ny));
  const double corner = (a + b) / 2.0, flat = (a - b) / 2.0;
  if (t <= -corner) return 0.0;
  if (t >= corner) return 1.0;
  if (std::abs(t) <= flat) return 0.5 + t / a;
  const double rest = corner - std::abs(t);
  const double cut = rest * rest / (2.0 * a * b);
  return t > 0 ? 1.0 - cut : cut;
}

}  // namespace

void Pen::cover(double x0, double y0, double x1, double y1, double half) {
  const double reach = half + 1.0;
  // Doubles first: a line may lie far outside of the box.
  const auto bound = [](double v, int low, int high) {
    return static_cast<int>(std::clamp(v, static_cast<double>(low), static_cast<double>(high)));
  };
  const int left = bound(std::floor(std::min(x0, x1) - reach), clip_.x, clip_.x + clip_.width);
  const int right = bound(std::ceil(std::max(x0, x1) + reach), clip_.x, clip_.x + clip_.width);
  const int top = bound(std::floor(std::min(y0, y1) - reach), clip_.y, clip_.y + clip_.height);
  const int bottom = bound(std::ceil(std::max(y0, y1) + reach), clip_.y, clip_.y + clip_.height);
  const double dx = x1 - x0, dy = y1 - y0, length = std::hypot(dx, dy);
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x) {
      const double px = x + 0.5 - x0, py = y + 0.5 - y0;
      const double along = length > 0 ? std::clamp((px * dx + py * dy) / (length * length), 0.0, 1.0) : 0.0;
      const double away_x = px - along * dx, away_y = py - along * dy;
      const double distance = std::hypot(away_x, away_y);
      constexpr double on_the_line = 1e-9;
      const bool on = distance < on_the_line;
      const double nx = on ? (length > 0 ? -dy / length : 1.0) : away_x / distance;
      const double ny = on ? (length > 0 ? dx / length : 0.0) : away_y / distance;
      const double share = square_below(half - distance, nx, ny) - square_below(-half - distance, nx, ny);
      if (share <= 0.0) continue;
      const size_t at = static_cast<size_t>(y - clip_.y) * static_cast<size_t>(clip_.width) + static_cast<size_t>(x - clip_.x);
      if (share_[at] == 0.0f) touched_.push_back(at);
      share_[at] = std::max(share_[at], static_cast<float>(share));
    }
}

void Pen::line(const std::vector<double>& x, const std::vector<double>& y, double width, core::Rgb colour, double opacity) {
  for (size_t k = 1; k < x.size(); ++k) cover(x[k - 1], y[k - 1], x[k], y[k], width / 2.0);
  const auto columns = static_cast<size_t>(clip_.width);
  for (const size_t at : touched_) {
    mix(*picture_, clip_.x + static_cast<int>(at % columns), clip_.y + static_cast<int>(at / columns), colour, opacity * share_[at]);
    share_[at] = 0.0f;
  }
  touched_.clear();
}

namespace {

/// A text as dots with an empty rim of two, and the same grown by one dot on all sides.
struct Dots {
  static constexpr int rim = 2;
  int width, height;
  std::vector<bool> ink, grown;

  explicit Dots(std::string_view text)
      : width(text_dots(text) + 2 * rim), height(glyph_height + 2 * rim), ink(static_cast<size_t>(width * height)), grown(ink) {
    int left = rim;
    for (const char32_t code : code_points(text)) {
      const Glyph& g = glyph_of(code);
      for (int row = 0; row < glyph_height; ++row)
        for (int dot = 0; dot < glyph_width; ++dot)
          if (g[static_cast<size_t>(row)] >> (glyph_width - 1 - dot) & 1) put(left + dot, rim + row);
      left += glyph_advance;
    }
  }
  size_t at(int u, int v) const { return static_cast<size_t>(v * width + u); }
  void put(int u, int v) {
    ink[at(u, v)] = true;
    for (int dv = -1; dv <= 1; ++dv)
      for (int du = -1; du <= 1; ++du) grown[at(u + du, v + dv)] = true;
  }
  bool holds(int u, int v) const { return u >= 0 && v >= 0 && u < width && v < height; }
};

}  // namespace

void draw_text(core::Picture& p, double cx, double cy, std::string_view text, double scale, double angle, core::Rgb colour,
               std::optional<core::Rgb> halo) {
  const Dots dots(text);
  // The glyphs' middle is that of capitals and digits, seven rows tall.
  const double middle_u = dots.width / 2.0, middle_v = Dots::rim + glyph_baseline / 2.0;
  const double reach = scale * std::hypot(dots.width, dots.height) / 2.0 + 2.0;
  const double cosine = std::cos(angle) / scale, sine = std::sin(angle) / scale;
  constexpr int samples = 4;  // along each side of a pixel
  for (int y = static_cast<int>(cy - reach); y <= static_cast<int>(cy + reach); ++y)
    for (int x = static_cast<int>(cx - reach); x <= static_cast<int>(cx + reach); ++x) {
      if (!p.holds(x, y)) continue;
      int ink = 0, grown = 0;
      for (int sy = 0; sy < samples; ++sy)
        for (int sx = 0; sx < samples; ++sx) {
          const double dx = x + (sx + 0.5) / samples - cx, dy = y + (sy + 0.5) / samples - cy;
          const int u = static_cast<int>(std::floor(middle_u + dx * cosine + dy * sine));
          const int v = static_cast<int>(std::floor(middle_v - dx * sine + dy * cosine));
          if (!dots.holds(u, v)) continue;
          ink += dots.ink[dots.at(u, v)];
          grown += dots.grown[dots.at(u, v)];
        }
      constexpr double all = samples * samples;
      if (halo) mix(p, x, y, *halo, grown / all);
      mix(p, x, y, colour, ink / all);
    }
}

int draw_label(core::Picture& p, int left, int top, std::string_view text, int scale, core::Rgb colour) {
  const int width = text_dots(text) * scale;
  draw_text(p, left + width / 2.0, top + glyph_baseline * scale / 2.0, text, scale, 0.0, colour);
  return width;
}

}  // namespace swath::report
