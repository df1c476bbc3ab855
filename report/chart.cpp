// SPDX-License-Identifier: GPL-3.0-or-later
// Where the parts of a chart lie. Margins follow from the texts within them.
#include "report/chart.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

#include "core/error.h"
#include "report/chart_marks.h"

namespace swath::report {
namespace {

constexpr core::Rgb border_colour{120, 120, 120}, faint{228, 228, 228}, zero_colour{170, 170, 170};
constexpr double text_size = 13.0, title_size = 18.0;  // pixels
constexpr int pad = 10, gap = 8, sample_width = 26;
constexpr double x_margin = 0.01, y_margin = 0.05;
/// Room along an axis for one tick, pixels.
constexpr int x_tick_room = 110, y_tick_room = 36;

int line_height(double size) { return static_cast<int>(std::ceil(1.1 * size)) + 5; }

void check(const Panel& panel) {
  for (const Series& s : panel.series)
    if (s.x.size() != s.y.size() || (!s.y2.empty() && s.y2.size() != s.y.size()))
      throw core::Error("a row of numbers of a chart has columns of different length", panel.title + ": " + s.name,
                        "this is a fault of the program");
}

Reach x_reach(const Panel& panel) {
  Reach r;
  for (const Series& s : panel.series)
    for (size_t k = 0; k < s.x.size(); ++k)
      if (std::isfinite(s.y[k])) r.add(s.x[k]);
  return r;
}

Reach y_reach(const Panel& panel) {
  Reach r;
  const bool positive = panel.log_y && !panel.equal_scale;
  for (const Series& s : panel.series) {
    if (s.mark == Mark::stems && !positive) r.add(0.0);
    for (size_t k = 0; k < s.y.size(); ++k) {
      if (!std::isfinite(s.x[k])) continue;
      r.add(s.y[k], positive);
      if (s.mark == Mark::band) r.add(s.y2.empty() ? -s.y[k] : s.y2[k], positive);
    }
  }
  return r;
}

/// The range that y_share asks for, and how many values lie beyond it.
Reach shown_reach(const Panel& panel, size_t& beyond) {
  if (!(panel.y_share < 1.0) || panel.equal_scale) return y_reach(panel);
  std::vector<double> values;
  for (const Series& s : panel.series) {
    values.insert(values.end(), s.y.begin(), s.y.end());
    if (s.mark == Mark::stems && !panel.log_y) values.push_back(0.0);
    if (s.mark != Mark::band) continue;
    for (size_t k = 0; k < s.y.size(); ++k) values.push_back(s.y2.empty() ? -s.y[k] : s.y2[k]);
  }
  const Reach out = middle_reach(std::move(values), panel.y_share, panel.log_y);
  for (const Series& s : panel.series)
    if (s.mark != Mark::band)
      beyond += static_cast<size_t>(std::count_if(s.y.begin(), s.y.end(), [&](double v) { return v < out.low || v > out.high; }));
  return out;
}

Reach widened(const Reach& r, double length) {
  Reach out;
  const double middle = (r.low + r.high) / 2.0;
  out.add(middle - length / 2.0);
  out.add(middle + length / 2.0);
  return out;
}

/// One unit of x for each kind.
Axis kinds_axis(const Panel& panel) {
  Axis a;
  a.low = -0.5;
  a.high = static_cast<double>(panel.x_names.size()) - 0.5;
  a.label = panel.x_label;
  for (size_t k = 0; k < panel.x_names.size(); ++k) a.ticks.push_back({static_cast<double>(k), panel.x_names[k]});
  return a;
}

struct LegendItem {
  const Series* series;
  core::Rgb colour;
  int left = 0, line = 0;
};

/// One panel on its way to its place.
struct Piece {
  const Panel* panel = nullptr;
  std::string title;
  Plot plot;
  std::vector<core::Rgb> colours;
  std::vector<LegendItem> legend;
  int legend_lines = 0;
  bool x_texts = true;  ///< the last of those that share x and follow one another
};

class Layout {
 public:
  explicit Layout(const Chart& chart) : chart_(chart) {
    for (const Panel& p : chart.panels) {
      check(p);
      Piece piece;
      piece.panel = &p;
      piece.title = p.title;
      int next = 0;
      for (const Series& s : p.series) piece.colours.push_back(palette(s.colour < 0 ? next++ : s.colour));
      pieces_.push_back(std::move(piece));
    }
    for (size_t i = 0; i + 1 < pieces_.size(); ++i) pieces_[i].x_texts = !shares(pieces_[i], pieces_[i + 1]);
    y_axes();
    margins();
    x_axes();
    for (Piece& p : pieces_) place_legend(p);
    stack();
  }

  int height() const { return height_; }
  void draw(Canvas& canvas) const;

 private:
  static bool shares(const Piece& a, const Piece& b) {
    return !a.panel->equal_scale && !b.panel->equal_scale && a.panel->x_label == b.panel->x_label;
  }
  void y_axes();
  void margins();
  void x_axes();
  void place_legend(Piece& piece) const;
  void stack();
  void draw_frame(const Piece& piece, Canvas& canvas) const;
  void draw_texts(const Piece& piece, Canvas& canvas) const;

  const Chart& chart_;
  std::vector<Piece> pieces_;
  int left_ = 0, plot_width_ = 0, height_ = 0;
};

/// Ranges of y first: their texts decide the left margin, which decides the width.
void Layout::y_axes() {
  for (Piece& p : pieces_) {
    p.plot.box.height = chart_.panel_height;
    size_t beyond = 0;
    p.plot.y = make_axis(shown_reach(*p.panel, beyond), p.panel->y_label, std::max(2, chart_.panel_height / y_tick_room), y_margin,
                         p.panel->log_y && !p.panel->equal_scale);
    if (beyond)
      p.title +=
          (p.title.empty() ? "" : " ") + ("(" + std::to_string(beyond) + (beyond == 1 ? " value" : " values") + " beyond the frame)");
  }
}

void Layout::margins() {
  double tick_width = 0.0, right = 0.0;
  for (const Piece& p : pieces_)
    for (const Tick& t : p.plot.y.ticks) tick_width = std::max(tick_width, text_width(t.text, text_size));
  // Maps get other ticks once their scale is known; these are not longer than the reach's ends.
  left_ = pad + line_height(text_size) + gap + static_cast<int>(std::ceil(tick_width)) + gap;
  for (Piece& p : pieces_) {
    const Axis trial = make_axis(x_reach(*p.panel), p.panel->x_label, std::max(2, chart_.width / x_tick_room), x_margin);
    for (const Tick& t : trial.ticks) right = std::max(right, text_width(t.text, text_size) / 2.0);
  }
  plot_width_ = std::max(50, chart_.width - left_ - pad - static_cast<int>(std::ceil(right)));
}

void Layout::x_axes() {
  const int most_x = std::max(2, plot_width_ / x_tick_room);
  std::map<std::string, Reach> shared;
  for (const Piece& p : pieces_) {
    if (p.panel->equal_scale) continue;
    const Reach r = x_reach(*p.panel);
    if (r.empty()) continue;
    Reach& all = shared[p.panel->x_label];
    all.add(r.low);
    all.add(r.high);
  }
  for (Piece& p : pieces_) {
    Box& box = p.plot.box;
    box.x = left_;
    box.width = plot_width_;
    if (!p.panel->equal_scale) {
      p.plot.x = p.panel->x_names.empty() ? make_axis(shared[p.panel->x_label], p.panel->x_label, most_x, x_margin) : kinds_axis(*p.panel);
      continue;
    }
    // One unit is as long across as up: the height follows from the width within limits, beyond which the shorter range grows.
    const Reach x = x_reach(*p.panel), y = y_reach(*p.panel);
    const double grown = 1.0 + 2.0 * y_margin, least = 1e-9;
    double across = std::max((x.high - x.low) * grown, least), up = std::max((y.high - y.low) * grown, least);
    if (across <= least && up <= least) across = up = 1.0;
    box.height = std::clamp(static_cast<int>(plot_width_ * std::min(up / across, 1.0)), chart_.panel_height,
                            std::max(chart_.panel_height, plot_width_ * 2 / 3));
    const double scale = std::max(across / box.width, up / box.height);
    p.plot.x = make_axis(widened(x, scale * box.width), p.panel->x_label, most_x, 0.0);
    p.plot.y = make_axis(widened(y, scale * box.height), p.panel->y_label, std::max(2, box.height / x_tick_room), 0.0);
  }
}

/// From the left, onto a new line where the panel ends; under the title.
void Layout::place_legend(Piece& p) const {
  int at = 0, line = 0;
  for (size_t k = 0; k < p.panel->series.size(); ++k) {
    const Series& s = p.panel->series[k];
    if (s.name.empty()) continue;
    const int width = sample_width + gap + static_cast<int>(std::ceil(text_width(s.name, text_size))) + 2 * gap;
    if (at > 0 && at + width > plot_width_) {
      at = 0;
      ++line;
    }
    p.legend.push_back({&s, p.colours[k], at, line});
    at += width;
  }
  p.legend_lines = p.legend.empty() ? 0 : line + 1;
  // Beside the title where both have room on one line.
  const double title = p.title.empty() ? 0.0 : text_width(p.title, text_size, true) + 4 * gap;
  if (p.legend_lines == 1 && title + at <= plot_width_) {
    for (LegendItem& item : p.legend) item.left += plot_width_ - at + 2 * gap;
    if (!p.title.empty()) p.legend_lines = 0;
  }
}

void Layout::stack() {
  int y = pad + (chart_.title.empty() ? 0 : line_height(title_size) + gap);
  for (Piece& p : pieces_) {
    y += (p.title.empty() ? 0 : line_height(text_size)) + p.legend_lines * line_height(text_size) + gap / 2;
    p.plot.box.y = y;
    y += p.plot.box.height + gap;
    if (p.x_texts) y += 2 * line_height(text_size) + gap;
  }
  height_ = y + pad;
}

void Layout::draw_frame(const Piece& p, Canvas& canvas) const {
  const Box& b = p.plot.box;
  const double left = b.x, right = b.x + b.width, top = b.y, bottom = b.y + b.height;
  const auto crisp = [](double v) { return std::floor(v) + 0.5; };
  constexpr double gap_between = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> x, y;
  const auto add = [&](double x0, double y0, double x1, double y1) {
    x.insert(x.end(), {x0, x1, gap_between});
    y.insert(y.end(), {y0, y1, gap_between});
  };
  for (const Tick& t : p.plot.x.ticks) add(crisp(p.plot.column(t.value)), top, crisp(p.plot.column(t.value)), bottom);
  for (const Tick& t : p.plot.y.ticks) add(left, crisp(p.plot.row(t.value)), right, crisp(p.plot.row(t.value)));
  canvas.line(x, y, 1.0, faint);
  const double zero = crisp(p.plot.row(0.0));
  if (!p.plot.y.log && p.plot.y.low <= 0.0 && p.plot.y.high >= 0.0) canvas.line({left, right}, {zero, zero}, 1.0, zero_colour);
}

void Layout::draw_texts(const Piece& p, Canvas& canvas) const {
  const Box& b = p.plot.box;
  const double left = b.x, right = b.x + b.width, top = b.y, bottom = b.y + b.height, half = line_height(text_size) / 2.0;
  canvas.frame({b.x - 1, b.y - 1, b.width + 2, b.height + 2}, border_colour);

  const int title_line = p.title.empty() ? 0 : line_height(text_size);
  const double head = top - gap / 2.0 - p.legend_lines * line_height(text_size);
  const auto middle = [](double room) { return TextStyle{.size = text_size, .anchor = Anchor::middle, .room = room}; };
  canvas.text(left, head - title_line / 2.0, p.title, {.size = text_size, .bold = true, .room = plot_width_ + 0.0});
  for (const LegendItem& item : p.legend) {
    const double y = p.legend_lines == 0 ? head - title_line / 2.0 : head + item.line * line_height(text_size) + half;
    const double x = left + item.left;
    draw_sample(item.series->mark, item.colour, x, y, sample_width, canvas);
    canvas.text(x + sample_width + gap, y, item.series->name, {.size = text_size, .room = right - x - sample_width - gap});
  }

  for (const Tick& t : p.plot.y.ticks)
    canvas.text(left - gap, p.plot.row(t.value), t.text,
                {.size = text_size, .anchor = Anchor::end, .room = left_ - pad - 2.0 * gap - line_height(text_size)});
  const double room = b.height + (p.x_texts ? 2.0 : 0.0) * half + title_line;
  canvas.text(pad + half, top + b.height / 2.0, p.plot.y.label,
              {.size = text_size, .anchor = Anchor::middle, .angle = upward, .room = room});
  if (!p.x_texts) return;
  const double each = p.panel->x_names.empty() ? plot_width_ : static_cast<double>(b.width) / static_cast<double>(p.panel->x_names.size());
  for (const Tick& t : p.plot.x.ticks) canvas.text(p.plot.column(t.value), bottom + gap + half, t.text, middle(each - gap));
  canvas.text(left + b.width / 2.0, bottom + gap + 3.0 * half, p.plot.x.label, middle(plot_width_));
}

void Layout::draw(Canvas& canvas) const {
  canvas.text(pad, pad + line_height(title_size) / 2.0, chart_.title, {.size = title_size, .bold = true, .room = chart_.width - 2.0 * pad});
  for (const Piece& p : pieces_) {
    canvas.clip(p.plot.box);
    draw_frame(p, canvas);
    bool any = false;
    for (const bool bands : {true, false})  // lines are never under a band
      for (size_t k = 0; k < p.panel->series.size(); ++k) {
        const Series& s = p.panel->series[k];
        if ((s.mark == Mark::band) == bands) draw_series(s, p.colours[k], p.plot, canvas);
        any = any || std::any_of(s.y.begin(), s.y.end(), [](double v) { return std::isfinite(v); });
      }
    canvas.clip(std::nullopt);
    draw_texts(p, canvas);
    if (!any)
      canvas.text(p.plot.box.x + p.plot.box.width / 2.0, p.plot.box.y + p.plot.box.height / 2.0, "no data",
                  {.size = text_size, .colour = border_colour, .anchor = Anchor::middle});
  }
}

}  // namespace

Drawing drawing(const Chart& chart) {
  const auto layout = std::make_shared<const Layout>(chart);
  return {chart.width, layout->height(), [layout](Canvas& canvas) { layout->draw(canvas); }};
}

}  // namespace swath::report
