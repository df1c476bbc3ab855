// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of numbers become marks. Colours: Okabe and Ito, "Color universal design", 2008 (yellow left out: too pale for lines on white).
#include "report/chart_marks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

namespace swath::report {
namespace {

constexpr double line_width = 1.5, stem_width = 1.2, dot_radius = 2.0, band_opacity = 0.25;
/// Beyond this distance from the plot nothing is seen, and files need no larger numbers.
constexpr double far_off = 1e5;

double near(double pixel) { return std::clamp(pixel, -far_off, far_off); }

/// Points of one pixel column that follow one another.
class PixelColumn {
 public:
  PixelColumn(Stretch& out, bool band) : out_(out), band_(band) {}
  void add(double x, double y, double lower) {
    const double c = std::floor(x);
    if (x_.empty() || c != column_) flush();
    column_ = c;
    x_.push_back(x);
    y_.push_back(y);
    if (band_) lower_.push_back(lower);
  }
  void flush() {
    if (x_.empty()) return;
    if (band_)
      flush_band();
    else
      flush_line();
    x_.clear();
    y_.clear();
    lower_.clear();
  }

 private:
  void flush_line() {
    const auto low = static_cast<size_t>(std::min_element(y_.begin(), y_.end()) - y_.begin());
    const auto high = static_cast<size_t>(std::max_element(y_.begin(), y_.end()) - y_.begin());
    for (const size_t k : std::set<size_t>{0, low, high, x_.size() - 1}) {
      out_.x.push_back(x_[k]);
      out_.y.push_back(y_[k]);
    }
  }
  void flush_band() {
    const double top = *std::min_element(y_.begin(), y_.end());  // rows count downwards
    const double bottom = *std::max_element(lower_.begin(), lower_.end());
    for (const size_t k : std::set<size_t>{0, x_.size() - 1}) {
      out_.x.push_back(x_[k]);
      out_.y.push_back(x_.size() > 2 ? top : y_[k]);
      out_.lower.push_back(x_.size() > 2 ? bottom : lower_[k]);
    }
  }
  Stretch& out_;
  bool band_;
  double column_ = 0.0;
  std::vector<double> x_, y_, lower_;
};

void draw_dots(const Series& s, core::Rgb colour, const Plot& plot, Canvas& canvas) {
  // Dots within half a pixel of one another cover the same.
  std::set<std::pair<long, long>> taken;
  std::vector<double> x, y;
  for (size_t k = 0; k < s.x.size(); ++k) {
    const double column = plot.column(s.x[k]);
    if (!std::isfinite(column) || !std::isfinite(plot.row(s.y[k]))) continue;
    const double row = std::clamp(plot.row(s.y[k]), 0.0 + plot.box.y, 0.0 + plot.box.y + plot.box.height);
    if (!taken.emplace(std::lround(2.0 * near(column)), std::lround(2.0 * near(row))).second) continue;
    x.push_back(near(column));
    y.push_back(near(row));
  }
  canvas.dots(x, y, dot_radius, colour);
}

void draw_stems(const Series& s, core::Rgb colour, const Plot& plot, Canvas& canvas) {
  // Per pixel column the longest stem upwards and the longest downwards.
  struct Ends {
    double top, bottom;
  };
  const double zero = plot.y.log ? plot.box.y + plot.box.height : near(plot.row(0.0));
  std::vector<Ends> ends(static_cast<size_t>(plot.box.width) + 1, {zero, zero});
  for (size_t k = 0; k < s.x.size(); ++k) {
    const double column = plot.column(s.x[k]) - plot.box.x, row = plot.row(s.y[k]);
    if (!std::isfinite(row) || !(column >= 0.0 && column <= plot.box.width)) continue;
    Ends& e = ends[static_cast<size_t>(column)];
    e.top = std::min(e.top, near(row));
    e.bottom = std::max(e.bottom, near(row));
  }
  std::vector<double> x, y;
  for (size_t c = 0; c < ends.size(); ++c) {
    if (ends[c].top >= ends[c].bottom) continue;
    const double column = plot.box.x + static_cast<double>(c) + 0.5;
    x.insert(x.end(), {column, column, column});
    y.insert(y.end(), {ends[c].top, ends[c].bottom, std::numeric_limits<double>::quiet_NaN()});
  }
  canvas.line(x, y, stem_width, colour);
}

}  // namespace

core::Rgb palette(int index) {
  constexpr std::array<core::Rgb, 7> colours{
      {{0, 114, 178}, {213, 94, 0}, {0, 158, 115}, {204, 121, 167}, {90, 90, 90}, {230, 159, 0}, {86, 180, 233}}};
  const int n = static_cast<int>(colours.size()), round = std::max(index, 0) / n % 3;
  core::Rgb out = colours[static_cast<size_t>((index % n + n) % n)];
  // The second time round darker, the third time paler.
  for (std::uint8_t& c : out) c = static_cast<std::uint8_t>(round == 0 ? c : round == 1 ? c * 11 / 20 : 255 - (255 - c) / 2);
  return out;
}

Reach middle_reach(std::vector<double> values, double share, bool log) {
  std::erase_if(values, [log](double v) { return !std::isfinite(v) || (log && v <= 0.0); });
  Reach out;
  if (values.empty()) return out;
  if (log)
    for (double& v : values) v = std::log(v);
  std::sort(values.begin(), values.end());
  const double last = static_cast<double>(values.size() - 1), beside = (1.0 - share) / 2.0;
  const double low = values[static_cast<size_t>(std::floor(beside * last))],
               high = values[static_cast<size_t>(std::ceil((1.0 - beside) * last))];
  const double more = 0.5 * (high - low);
  for (const double v : {std::max(low - more, values.front()), std::min(high + more, values.back())}) out.add(log ? std::exp(v) : v);
  return out;
}

std::vector<Stretch> stretches(const Series& s, const Plot& plot) {
  const bool band = s.mark == Mark::band;
  std::vector<Stretch> out;
  Stretch now;
  PixelColumn column(now, band);
  const auto end = [&] {
    column.flush();
    if (!now.x.empty()) out.push_back(std::move(now));
    now = {};
  };
  for (size_t k = 0; k < s.x.size(); ++k) {
    const double x = plot.column(s.x[k]);
    double y = plot.row(s.y[k]), lower = y;
    if (band) {
      lower = plot.row(s.y2.empty() ? -s.y[k] : s.y2[k]);
      // A logarithmic axis has no zero: the band then goes down to the plot's edge.
      if (plot.y.log && std::isfinite(y) && std::isnan(lower)) lower = plot.box.y + plot.box.height;
      if (y > lower) std::swap(y, lower);
    }
    if (std::isfinite(x) && std::isfinite(y) && std::isfinite(lower))
      column.add(near(x), near(y), near(lower));
    else
      end();
  }
  end();
  return out;
}

void draw_series(const Series& s, core::Rgb colour, const Plot& plot, Canvas& canvas) {
  switch (s.mark) {
    case Mark::dots:
      draw_dots(s, colour, plot, canvas);
      break;
    case Mark::stems:
      draw_stems(s, colour, plot, canvas);
      break;
    case Mark::band:
      for (const Stretch& one : stretches(s, plot)) canvas.area(one.x, one.y, one.lower, colour, band_opacity);
      break;
    case Mark::line:
      for (const Stretch& one : stretches(s, plot)) {
        if (one.x.size() > 1)
          canvas.line(one.x, one.y, line_width, colour);
        else
          canvas.dots(one.x, one.y, dot_radius, colour);  // a lone value between breaks
      }
      break;
  }
}

void draw_sample(Mark mark, core::Rgb colour, double x, double y, double width, Canvas& canvas) {
  switch (mark) {
    case Mark::dots:
      canvas.dots({x + width / 2.0}, {y}, dot_radius * 1.5, colour);
      break;
    case Mark::band:
      canvas.fill({static_cast<int>(x), static_cast<int>(y) - 5, static_cast<int>(width), 11}, colour, band_opacity);
      break;
    case Mark::stems:
    case Mark::line:
      canvas.line({x, x + width}, {y, y}, 2.0 * line_width, colour);
      break;
  }
}

}  // namespace swath::report
