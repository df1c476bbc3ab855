// SPDX-License-Identifier: GPL-3.0-or-later
// Drawings by Cairo: one description becomes pixels, SVG or PDF. Coordinates are pixels of 1/96 inch, x to the right, y down, the centre of
// the first pixel at (0.5, 0.5). Texts are set in DejaVu Sans without hinting, so that they are as wide in every kind of file; where that
// typeface is not installed fontconfig takes the nearest one, and without any fonts Cairo draws its own plain letters.
#pragma once

#include <concepts>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/picture.h"

struct _cairo;  // Cairo's context, known to canvas.cpp alone

namespace swath::report {

struct Box {
  int x = 0, y = 0, width = 0, height = 0;
  bool overlaps(const Box& o) const { return x < o.x + o.width && o.x < x + width && y < o.y + o.height && o.y < y + height; }
};

enum class Anchor { start, middle, end };

struct TextStyle {
  double size = 14.0;  ///< of the em square, pixels
  core::Rgb colour{40, 40, 40};
  Anchor anchor = Anchor::start;
  double angle = 0.0;  ///< clockwise, rad
  bool bold = false;
  std::optional<core::Rgb> halo{};  ///< a rim of that colour around the letters
  double room = 1e9;                ///< pixels; a wider text is set smaller
};

inline constexpr double upward = -1.5707963267948966;  ///< angle of a text that is read from below

/// Width of a text on every canvas, pixels; in proportion to its size.
double text_width(std::string_view utf8, double size, bool bold = false);

class Canvas {
 public:
  /// A text as it was drawn, from its baseline's left end.
  struct Label {
    std::string text;
    double x, y, width, size, angle;
  };

  explicit Canvas(_cairo* context) : cairo_(context) {}
  /// What follows is drawn inside the box alone; nothing: everywhere.
  void clip(const std::optional<Box>& box);
  void fill(const Box& box, core::Rgb colour, double opacity = 1.0);
  /// The outline of a box, one pixel wide, inside of it.
  void frame(const Box& box, core::Rgb colour);
  /// A line does not darken where it meets or crosses itself. A point without finite coordinates breaks it.
  void line(const std::vector<double>& x, const std::vector<double>& y, double width, core::Rgb colour, double opacity = 1.0);
  /// Discs.
  void dots(const std::vector<double>& x, const std::vector<double>& y, double radius, core::Rgb colour);
  /// Between two edges over rising x.
  void area(const std::vector<double>& x, const std::vector<double>& upper, const std::vector<double>& lower, core::Rgb colour,
            double opacity);
  /// (x, y): the anchor, at half the height of capitals. Damaged UTF-8 becomes U+FFFD, control characters blanks.
  void text(double x, double y, std::string_view utf8, const TextStyle& style);
  /// Pixel by pixel; `colour` takes column and row within the box.
  void pixels(const Box& box, const std::function<core::Rgb(int, int)>& colour);
  /// A drawing of its own within this one: its corner at (x, y), `scale` times its size.
  void inset(double x, double y, double scale, const std::function<void(Canvas&)>& paint);

  const std::vector<Label>& labels() const { return labels_; }

 private:
  void path(const std::vector<double>& x, const std::vector<double>& y);
  void stroke(double width, core::Rgb colour, double opacity);
  _cairo* cairo_;
  std::vector<Label> labels_;
};

/// A drawing on white, for every kind of file.
struct Drawing {
  int width = 0, height = 0;
  std::function<void(Canvas&)> paint;
};

/// The same drawing gives the same picture and the same bytes. One without width or height gives an empty picture or text. Throw
/// core::Error where Cairo cannot make it: a side has at most 32767 pixels.
core::Picture draw(const Drawing& drawing);
/// Letters are outlines, so that they look the same everywhere; an unseen text over each of them can be searched and copied.
std::string svg(const Drawing& drawing);
/// One page with its typeface, without dates.
std::string pdf(const Drawing& drawing);
/// A page for each drawing.
std::string pdf(const std::vector<Drawing>& pages);

/// The same of everything that has a drawing(): charts, correlations.
template <class T>
concept Drawn = requires(const T& what) {
  { drawing(what) } -> std::same_as<Drawing>;
};
template <Drawn T>
core::Picture draw(const T& what) {
  return draw(drawing(what));
}
template <Drawn T>
std::string svg(const T& what) {
  return svg(drawing(what));
}
template <Drawn T>
std::string pdf(const T& what) {
  return pdf(drawing(what));
}

}  // namespace swath::report
