// SPDX-License-Identifier: GPL-3.0-or-later
// The two sheets a chart is drawn on: pixels and SVG. Both take the same calls of the same layout (chart_layout.cpp).
#include "report/chart.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

#include "report/chart_parts.h"
#include "report/font.h"
#include "report/html.h"

namespace swath::report {
namespace {

class PictureSheet : public Sheet {
 public:
  explicit PictureSheet(core::Picture& p) : picture_(p), clip_{0, 0, p.width, p.height}, pen_(p, clip_) {}
  void clip(const std::optional<Box>& box) override {
    clip_ = box.value_or(Box{0, 0, picture_.width, picture_.height});
    pen_ = Pen(picture_, clip_);
  }
  void fill(const Box& box, core::Rgb colour, double opacity) override {
    for (int y = box.y; y < box.y + box.height; ++y)
      for (int x = box.x; x < box.x + box.width; ++x) put(x, y, colour, opacity);
  }
  void line(const std::vector<double>& x, const std::vector<double>& y, double width, core::Rgb colour) override {
    pen_.line(x, y, width, colour);
  }
  void dots(const std::vector<double>& x, const std::vector<double>& y, double radius, core::Rgb colour) override {
    for (size_t k = 0; k < x.size(); ++k) pen_.line({x[k], x[k]}, {y[k], y[k]}, 2.0 * radius, colour);
  }
  void area(const std::vector<double>& x, const std::vector<double>& upper, const std::vector<double>& lower, core::Rgb colour,
            double opacity) override;
  void text(double x, double y, std::string_view text, double scale, Anchor anchor, bool upward, core::Rgb colour) override {
    const double half = text_dots(text) * scale / 2.0;
    const double along = anchor == Anchor::start ? half : anchor == Anchor::end ? -half : 0.0;
    if (upward)
      draw_text(picture_, x, y - along, text, scale, -std::numbers::pi / 2.0, colour);
    else
      draw_text(picture_, x + along, y, text, scale, 0.0, colour);
  }

 private:
  void put(int x, int y, core::Rgb colour, double share) {
    if (x >= clip_.x && y >= clip_.y && x < clip_.x + clip_.width && y < clip_.y + clip_.height) mix(picture_, x, y, colour, share);
  }
  core::Picture& picture_;
  Box clip_;
  Pen pen_;
};

/// Each pixel column takes the widest span that the area has within it.
void PictureSheet::area(const std::vector<double>& x, const std::vector<double>& upper, const std::vector<double>& lower, core::Rgb colour,
                        double opacity) {
  const auto columns = static_cast<size_t>(clip_.width);
  constexpr double none = std::numeric_limits<double>::infinity();
  std::vector<double> top(columns, none), bottom(columns, -none);
  for (size_t k = 1; k < x.size(); ++k) {
    const double from = x[k - 1], to = x[k];
    const int first = static_cast<int>(std::max(std::floor(from), static_cast<double>(clip_.x)));
    const int last = static_cast<int>(std::min(std::floor(to), static_cast<double>(clip_.x + clip_.width - 1)));
    for (int c = first; c <= last; ++c)
      for (const double at : {std::max(from, static_cast<double>(c)), std::min(to, c + 1.0)}) {
        const double t = to > from ? (at - from) / (to - from) : 0.0;
        const auto column = static_cast<size_t>(c - clip_.x);
        top[column] = std::min(top[column], upper[k - 1] + t * (upper[k] - upper[k - 1]));
        bottom[column] = std::max(bottom[column], lower[k - 1] + t * (lower[k] - lower[k - 1]));
      }
  }
  for (size_t c = 0; c < columns; ++c) {
    const double high = std::max(top[c], static_cast<double>(clip_.y)),
                 low = std::min(bottom[c], static_cast<double>(clip_.y + clip_.height));
    for (int y = static_cast<int>(std::floor(std::min(high, low))); y < low; ++y) {
      const double share = std::min(low, y + 1.0) - std::max(high, static_cast<double>(y));
      put(clip_.x + static_cast<int>(c), y, colour, opacity * share);
    }
  }
}

/// Pixels with a tenth at most: finer than any screen shows, and the file stays small.
std::string number(double v) {
  char text[64];
  auto end = std::to_chars(text, text + sizeof text, v, std::chars_format::fixed, 1).ptr;
  if (end - text > 2 && end[-1] == '0') end -= 2;
  return std::string(text, end) == "-0" ? "0" : std::string(text, end);
}

std::string hex(core::Rgb c) {
  constexpr char digits[] = "0123456789abcdef";
  std::string out = "#";
  for (const std::uint8_t v : c) {
    out += digits[v >> 4];
    out += digits[v & 15];
  }
  return out;
}

std::string points(const std::vector<double>& x, const std::vector<double>& y) {
  std::string out;
  for (size_t k = 0; k < x.size(); ++k) out += (k ? " " : "") + number(x[k]) + "," + number(y[k]);
  return out;
}

class SvgSheet : public Sheet {
 public:
  explicit SvgSheet(std::string& out) : out_(out) {}
  void clip(const std::optional<Box>& box) override {
    if (open_) out_ += "</g>\n";
    open_ = box.has_value();
    if (!box) return;
    const std::string id = "plot" + std::to_string(++clips_);
    out_ += "<clipPath id=\"" + id + "\">" + rectangle(*box) + "/></clipPath>\n<g clip-path=\"url(#" + id + ")\">\n";
  }
  void fill(const Box& box, core::Rgb colour, double opacity) override {
    out_ += rectangle(box) + " fill=\"" + hex(colour) + "\" fill-opacity=\"" + number(opacity * 100.0) + "%\"/>\n";
  }
  void line(const std::vector<double>& x, const std::vector<double>& y, double width, core::Rgb colour) override {
    out_ += "<polyline points=\"" + points(x, y) + "\" fill=\"none\" stroke=\"" + hex(colour) + "\" stroke-width=\"" + number(width) +
            "\" stroke-linejoin=\"round\"/>\n";
  }
  void dots(const std::vector<double>& x, const std::vector<double>& y, double radius, core::Rgb colour) override {
    out_ += "<g fill=\"" + hex(colour) + "\">\n";
    for (size_t k = 0; k < x.size(); ++k)
      out_ += "<circle cx=\"" + number(x[k]) + "\" cy=\"" + number(y[k]) + "\" r=\"" + number(radius) + "\"/>\n";
    out_ += "</g>\n";
  }
  void area(const std::vector<double>& x, const std::vector<double>& upper, const std::vector<double>& lower, core::Rgb colour,
            double opacity) override {
    const std::vector<double> back_x(x.rbegin(), x.rend()), back_y(lower.rbegin(), lower.rend());
    out_ += "<polygon points=\"" + points(x, upper) + " " + points(back_x, back_y) + "\" fill=\"" + hex(colour) + "\" fill-opacity=\"" +
            number(opacity * 100.0) + "%\"/>\n";
  }
  void text(double x, double y, std::string_view text, double scale, Anchor anchor, bool upward, core::Rgb colour) override {
    // A sans-serif letter is 0.55 em wide in the mean: at this size no text is wider than the layout takes it to be. Capitals are 0.7 em.
    const double size = 9.5 * scale, baseline = 0.35 * size;
    out_ += "<text font-size=\"" + number(size) + "\" fill=\"" + hex(colour) + "\" text-anchor=\"" +
            (anchor == Anchor::start    ? "start"
             : anchor == Anchor::middle ? "middle"
                                        : "end") +
            "\"";
    if (upward)
      out_ += " transform=\"translate(" + number(x + baseline) + "," + number(y) + ") rotate(-90)\"";
    else
      out_ += " x=\"" + number(x) + "\" y=\"" + number(y + baseline) + "\"";
    out_ += ">" + escaped(text) + "</text>\n";
  }

 private:
  static std::string rectangle(const Box& b) {
    return "<rect x=\"" + std::to_string(b.x) + "\" y=\"" + std::to_string(b.y) + "\" width=\"" + std::to_string(b.width) + "\" height=\"" +
           std::to_string(b.height) + "\"";
  }
  std::string& out_;
  int clips_ = 0;
  bool open_ = false;
};

}  // namespace

core::Picture paint(int width, int height, const std::function<void(Sheet&)>& drawing) {
  core::Picture picture(width, height);
  PictureSheet sheet(picture);
  drawing(sheet);
  return picture;
}

std::string paint_svg(int width, int height, const std::function<void(Sheet&)>& drawing) {
  const std::string w = std::to_string(width), h = std::to_string(height);
  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + w + "\" height=\"" + h + "\" viewBox=\"0 0 " + w + " " + h +
                    "\" font-family=\"sans-serif\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  SvgSheet sheet(out);
  drawing(sheet);
  return out + "</svg>\n";
}

core::Picture draw(const Chart& chart) {
  return paint(chart.width, lay_out(chart, nullptr), [&](Sheet& sheet) { lay_out(chart, &sheet); });
}

std::string svg(const Chart& chart) {
  return paint_svg(chart.width, lay_out(chart, nullptr), [&](Sheet& sheet) { lay_out(chart, &sheet); });
}

}  // namespace swath::report
