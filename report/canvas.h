// SPDX-License-Identifier: GPL-3.0-or-later
// Drawing on a core::Picture: pixel coordinates, x to the right, y down, the centre of the first pixel at (0.5, 0.5).
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/picture.h"

namespace swath::report {

struct Box {
  int x = 0, y = 0, width = 0, height = 0;
  bool overlaps(const Box& o) const { return x < o.x + o.width && o.x < x + width && y < o.y + o.height && o.y < y + height; }
};

/// Mixes a colour into a pixel; share 0 to 1. Pixels outside the picture are passed over.
void mix(core::Picture& p, int x, int y, core::Rgb colour, double share);
void fill(core::Picture& p, const Box& box, core::Rgb colour);
/// The outline of a box, one pixel wide.
void frame(core::Picture& p, const Box& box, core::Rgb colour);

/// Draws smooth lines inside a box: a pixel's share is how much of it the line covers, and a line
/// never darkens where its own segments meet or cross.
class Pen {
 public:
  Pen(core::Picture& p, const Box& clip);
  /// Width in pixels; opacity 0 to 1.
  void line(const std::vector<double>& x, const std::vector<double>& y, double width, core::Rgb colour, double opacity = 1.0);

 private:
  void cover(double x0, double y0, double x1, double y1, double half_width);
  core::Picture* picture_;
  Box clip_;
  std::vector<float> share_;  // of each pixel of the clip box
  std::vector<size_t> touched_;
};

/// Text around its centre (x, y), turned clockwise by `angle` (rad), `scale` pixels per dot; with `halo`, one dot of that colour around
/// it. Uses report/font.h.
void draw_text(core::Picture& p, double x, double y, std::string_view text, double scale, double angle, core::Rgb colour,
               std::optional<core::Rgb> halo = std::nullopt);
/// Level text from its upper left corner; returns its width in pixels.
int draw_label(core::Picture& p, int left, int top, std::string_view text, int scale, core::Rgb colour);

}  // namespace swath::report
