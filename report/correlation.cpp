// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/correlation.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "report/difference_map.h"

namespace swath::report {
namespace {

constexpr core::Rgb on_light{40, 40, 40}, on_dark{255, 255, 255};
constexpr int matrix_pad = 12, matrix_gap = 8, row = 34, least_cell = 66;
constexpr double label_size = 13.0, heading_size = 18.0;
constexpr double dark = 0.75;  // white letters from here on

int width_of(const std::string& text, double size, bool bold = false) { return static_cast<int>(std::ceil(text_width(text, size, bold))); }

/// Two decimals; the diagonal without any.
std::string coefficient(double v, bool diagonal) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, v, std::chars_format::fixed, diagonal ? 0 : 2).ptr;
  const std::string out(text, end);
  return out == "-0.00" ? "0.00" : out;
}

struct CellLayout {
  explicit CellLayout(const CorrelationChart& c) : chart(c), n(static_cast<int>(c.names.size())) {
    if (c.values.size() != c.names.size() * c.names.size())
      throw core::Error("a correlation matrix needs as many rows and columns as it has names", c.title, "this is a fault of the program");
    int longest = 0;
    for (const std::string& name : c.names) longest = std::max(longest, width_of(name, label_size));
    // Names stand before their rows, and upwards below their columns.
    left = matrix_pad + longest + matrix_gap;
    top = matrix_pad + (c.title.empty() ? 0 : static_cast<int>(heading_size) + 2 * matrix_gap);
    width = std::max(left + n * least_cell + matrix_pad, c.title.empty() ? 0 : width_of(c.title, heading_size, true) + 2 * matrix_pad);
    height = top + n * row + matrix_gap + longest + matrix_pad;
  }
  void draw(Canvas& canvas) const {
    canvas.text(matrix_pad, matrix_pad + heading_size / 2.0, chart.title, {.size = heading_size, .bold = true});
    for (int r = 0; r < n; ++r) {
      const double y = top + (r + 0.5) * row;
      canvas.text(left - matrix_gap, y, chart.names[static_cast<size_t>(r)], {.size = label_size, .anchor = Anchor::end});
      for (int c = 0; c <= r; ++c) {
        const double v = chart.values[static_cast<size_t>(r) * static_cast<size_t>(n) + static_cast<size_t>(c)];
        if (!std::isfinite(v)) continue;
        canvas.fill({left + c * least_cell + 1, top + r * row + 1, least_cell - 2, row - 2}, diverging_colour(v));
        canvas.text(left + (c + 0.5) * least_cell, y, coefficient(v, r == c),
                    {.size = label_size, .colour = std::abs(v) > dark ? on_dark : on_light, .anchor = Anchor::middle});
      }
    }
    for (int c = 0; c < n; ++c)
      canvas.text(left + (c + 0.5) * least_cell, top + n * row + matrix_gap, chart.names[static_cast<size_t>(c)],
                  {.size = label_size, .anchor = Anchor::end, .angle = upward});
  }
  const CorrelationChart& chart;
  int n, left = 0, top = 0, width = 0, height = 0;
};

}  // namespace

Drawing drawing(const CorrelationChart& chart) {
  const auto layout = std::make_shared<const CellLayout>(chart);
  return {layout->width, layout->height, [layout](Canvas& canvas) { layout->draw(canvas); }};
}

}  // namespace swath::report
