// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/chart.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/error.h"
#include "report/chart_marks.h"
#include "tests/world/support.h"

namespace swath::report {
namespace {

/// Around every plot.
constexpr core::Rgb border_colour{120, 120, 120};
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::vector<double> ramp(size_t n, double first, double last) {
  std::vector<double> x(n);
  for (size_t k = 0; k < n; ++k) x[k] = first + (last - first) * static_cast<double>(k) / static_cast<double>(std::max<size_t>(n - 1, 1));
  return x;
}

Panel panel(Series series) {
  Panel p;
  p.title = "Height";
  p.x_label = "time (s)";
  p.y_label = "height (m)";
  p.series.push_back(std::move(series));
  return p;
}

Chart chart_of(std::vector<Panel> panels) {
  Chart c;
  c.panels = std::move(panels);
  c.width = 600;
  c.panel_height = 200;
  return c;
}

/// The box of pixels of a colour; hues: also where they are mixed with paper.
struct Found {
  int left = 1 << 30, right = -1, top = 1 << 30, bottom = -1, n = 0;
};
bool bluish(const std::uint8_t* c) { return c[2] > c[0] + 40; }
bool reddish(const std::uint8_t* c) { return c[0] > c[2] + 60; }
template <class Is>
Found find(const core::Picture& p, Is is) {
  Found f;
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x)
      if (is(p.at(x, y))) {
        f.left = std::min(f.left, x);
        f.right = std::max(f.right, x);
        f.top = std::min(f.top, y);
        f.bottom = std::max(f.bottom, y);
        ++f.n;
      }
  return f;
}

/// The rim of the plot: rows and columns that are its colour over a good part of their length.
Found rim(const core::Picture& p) {
  Found f;
  const auto is = [&](int x, int y) { return std::equal(border_colour.begin(), border_colour.end(), p.at(x, y)); };
  for (int y = 0; y < p.height; ++y) {
    int n = 0;
    for (int x = 0; x < p.width; ++x) n += is(x, y);
    if (n < p.width / 2) continue;
    f.top = std::min(f.top, y);
    f.bottom = std::max(f.bottom, y);
  }
  for (int x = 0; x < p.width; ++x) {
    int n = 0;
    for (int y = 0; y < p.height; ++y) n += is(x, y);
    if (n < p.height / 2) continue;
    f.left = std::min(f.left, x);
    f.right = std::max(f.right, x);
  }
  return f;
}

size_t count(const std::string& text, const std::string& part) {
  size_t n = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

Plot plot_of(double x0, double x1, double y0, double y1) {
  Plot p;
  p.box = {100, 50, 400, 200};
  Reach x, y;
  for (const double v : {x0, x1}) x.add(v);
  for (const double v : {y0, y1}) y.add(v);
  p.x = make_axis(x, "x", 5, 0.0);
  p.y = make_axis(y, "y", 5, 0.0);
  return p;
}

TEST(Chart, ThinningKeepsEveryPeakAndBoundsTheNumberOfPoints) {
  Series s{"noise", ramp(1000000, 0, 1000), std::vector<double>(1000000, 0.0), {}, Mark::line, -1};
  s.y[333333] = 9.0;
  s.y[777777] = -7.0;
  const auto out = stretches(s, plot_of(0, 1000, -10, 10));
  ASSERT_EQ(out.size(), 1u);
  EXPECT_LE(out[0].x.size(), 4u * 401u);
  const Plot plot = plot_of(0, 1000, -10, 10);
  EXPECT_DOUBLE_EQ(*std::min_element(out[0].y.begin(), out[0].y.end()), plot.row(9.0));
  EXPECT_DOUBLE_EQ(*std::max_element(out[0].y.begin(), out[0].y.end()), plot.row(-7.0));
  EXPECT_TRUE(std::is_sorted(out[0].x.begin(), out[0].x.end()));
  // The same for a band's edges.
  s.mark = Mark::band;
  s.y2.assign(s.y.size(), -1.0);
  s.y2[5000] = -8.0;
  const auto band = stretches(s, plot);
  ASSERT_EQ(band.size(), 1u);
  EXPECT_LE(band[0].x.size(), 2u * 401u);
  EXPECT_DOUBLE_EQ(*std::min_element(band[0].y.begin(), band[0].y.end()), plot.row(9.0));
  EXPECT_DOUBLE_EQ(*std::max_element(band[0].lower.begin(), band[0].lower.end()), plot.row(-8.0));
}

TEST(Chart, ABreakLeavesAGap) {
  const Plot plot = plot_of(0, 10, 0, 1);
  const Series s{"", {0, 1, 2, 3, 4, 5}, {0, 1, nan, 1, 0, std::numeric_limits<double>::infinity()}, {}, Mark::line, -1};
  const auto out = stretches(s, plot);
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(out[0].x.size(), 2u);
  EXPECT_DOUBLE_EQ(out[1].x.front(), plot.column(3));

  Series line{"", ramp(101, 0, 100), std::vector<double>(101, 5.0), {}, Mark::line, -1};
  for (size_t k = 40; k <= 60; ++k) line.y[k] = nan;
  line.y[50] = 5.0;  // a lone value
  const core::Picture p = draw(chart_of({panel(line)}));
  const Found f = find(p, bluish);
  ASSERT_GT(f.n, 0);
  int gaps = 0;
  bool lone = false;
  for (int x = f.left; x <= f.right; ++x) {
    const bool white = *p.at(x, (f.top + f.bottom) / 2) >= 228;  // paper or grid
    gaps += white;
    lone = lone || (!white && gaps > 20 && gaps < 60);
  }
  EXPECT_GT(gaps, 60);
  EXPECT_TRUE(lone);
}

TEST(Chart, AHigherValueLiesHigherAndFillsThePlot) {
  const core::Picture p = draw(chart_of({panel({"", {0, 100}, {10, 20}, {}, Mark::line, -1})}));
  EXPECT_EQ(p.width, 600);
  int first = -1, last = -1;  // rows of the line near its ends
  const Found all = rim(p);
  const auto row_at = [&](int x) {
    double sum = 0.0, share = 0.0;
    for (int y = all.top + 2; y < all.bottom - 1; ++y) {
      const std::uint8_t* c = p.at(x, y);
      const double blueness = std::max(0, c[2] - c[0]);
      sum += blueness * y;
      share += blueness;
    }
    return share > 0 ? sum / share : -1.0;
  };
  first = static_cast<int>(row_at(all.left + 20));
  last = static_cast<int>(row_at(all.right - 20));
  EXPECT_GT(first, last + 150);
  EXPECT_LE(first, all.bottom);
  EXPECT_GE(last, all.top);
}

TEST(Chart, AMapHasOneScaleOnBothAxes) {
  for (const double stretch : {0.2, 1.0, 5.0}) {
    Series s{"track", {}, {}, {}, Mark::line, 0};
    for (int k = 0; k <= 720; ++k) {
      s.x.push_back(500000 + 300.0 * std::cos(k * 0.0174533));
      s.y.push_back(stretch * 300.0 * std::sin(k * 0.0174533));
    }
    Panel map = panel(s);
    map.equal_scale = true;
    map.series[0].name.clear();
    Chart c = chart_of({map});
    const Found f = find(draw(c), bluish);
    EXPECT_NEAR((f.bottom - f.top) / static_cast<double>(f.right - f.left), stretch, 0.03 * stretch) << stretch;
  }
}

TEST(Chart, BandsStemsAndDotsCoverWhatTheyShould) {
  const auto share_of_tinted = [](Mark mark) {
    Series s{"", ramp(2001, 0, 100), std::vector<double>(2001, 1.0), {}, mark, 0};
    Panel p = panel(s);
    p.series.push_back({"", {0, 100}, {2, -2}, {}, Mark::dots, 1});  // to set the range: -2 to 2
    const core::Picture picture = draw(chart_of({p}));
    const Found plot = rim(picture);
    int tinted = 0;
    for (int y = plot.top + 1; y < plot.bottom; ++y)
      for (int x = plot.left + 1; x < plot.right; ++x) tinted += picture.at(x, y)[2] > picture.at(x, y)[0] + 40;
    return tinted / static_cast<double>((plot.bottom - plot.top) * (plot.right - plot.left));
  };
  // Of 4 units in 4.4 the band covers 2, the stems 1, dots a row of 4 pixels in 200.
  EXPECT_NEAR(share_of_tinted(Mark::band), 2.0 / 4.4, 0.03);
  EXPECT_NEAR(share_of_tinted(Mark::stems), 1.0 / 4.4, 0.03);
  EXPECT_NEAR(share_of_tinted(Mark::dots), 4.0 / 200.0, 0.01);
}

TEST(Chart, ABandBetweenItsOwnEdgesAndALineAboveIt) {
  Panel p = panel({"line", {0, 100}, {3, 3}, {}, Mark::line, 1});
  p.series.push_back({"band", {0, 100}, {4, 4}, {2, 2}, Mark::band, 0});
  p.series.push_back({"", {0, 100}, {0, 6}, {}, Mark::dots, 2});
  const core::Picture picture = draw(chart_of({p}));
  const Found plot = rim(picture);
  const int middle = (plot.left + plot.right) / 2, height = plot.bottom - plot.top;
  const auto tinted = [&](double value) {
    const int y = plot.bottom - static_cast<int>(height * (value + 0.3) / 6.6);
    return picture.at(middle + 3, y)[2] > picture.at(middle + 3, y)[0] + 30;
  };
  EXPECT_FALSE(tinted(1.7));
  EXPECT_TRUE(tinted(2.3));
  EXPECT_TRUE(tinted(3.7));
  EXPECT_FALSE(tinted(4.3));
  EXPECT_GT(find(picture, reddish).n, 300);  // the line was drawn later: the band does not pale it
}

/// Charts with everything that needs room: long names, large numbers, several panels.
std::vector<Chart> crowded() {
  Chart c = chart_of({});
  c.title = "Smoothed trajectory of the flight over the northern valley, second day, with everything that was measured on the way";
  Panel a = panel(
      {"a rather long name of the first row of numbers", ramp(50, 1400474012.3, 1400474890.1), ramp(50, -1e7, 1e7), {}, Mark::line, -1});
  a.series.push_back({"the second row, no less long than the first one", a.series[0].x, ramp(50, 3e6, 4e6), {}, Mark::band, -1});
  a.series.push_back({"third", a.series[0].x, ramp(50, -3e6, 4e6), {}, Mark::stems, -1});
  a.series.push_back({"a name that alone is far wider than the whole of the picture can ever be: it must be made smaller than the others",
                      a.series[0].x,
                      ramp(50, 3e6, 4e6),
                      {},
                      Mark::dots,
                      -1});
  a.y_label = "a label of the axis that is longer than the panel is high (unit of it)";
  Panel b = a;
  b.series.resize(1);
  b.log_y = true;
  b.title.clear();
  b.series[0].y = ramp(50, 1e-9, 3e8);
  Panel map = a;
  map.equal_scale = true;
  map.x_label = "easting from the first position of the trajectory of the whole flight, which makes a long label (m)";
  map.title = c.title + " " + c.title;
  c.panels = {a, b, map};
  Chart tiny = c;
  tiny.width = 240;
  tiny.panel_height = 60;
  Chart empty = chart_of({panel({"", {}, {}, {}, Mark::line, -1}), panel({"", {1, 2}, {nan, nan}, {}, Mark::band, -1}), Panel()});
  return {c, tiny, empty};
}

TEST(Chart, NoTextIsCutOffAtThePicturesEdge) {
  for (const Chart& c : crowded()) {
    const core::Picture p = draw(c);
    constexpr int clear = 2;  // pixels that stay white all around
    int ink = 0;
    for (int y = 0; y < p.height; ++y)
      for (int x = 0; x < p.width; ++x)
        if (x < clear || y < clear || x >= p.width - clear || y >= p.height - clear) ink += *p.at(x, y) != 255;
    EXPECT_EQ(ink, 0) << c.width;
  }
}

TEST(Chart, NoTextLiesOnAnother) {
  struct Rectangle {
    double left, right, top, bottom;
  };
  for (const Chart& c : crowded()) {
    std::vector<Canvas::Label> labels;
    const Drawing d = drawing(c);
    draw(Drawing{d.width, d.height, [&](Canvas& canvas) {
                   d.paint(canvas);
                   labels = canvas.labels();
                 }});
    ASSERT_GT(labels.size(), 10u);
    std::vector<Rectangle> boxes;
    for (const Canvas::Label& l : labels) {
      const double capital = 0.73 * l.size;
      boxes.push_back(l.angle == 0.0 ? Rectangle{l.x, l.x + l.width, l.y - capital, l.y}
                                     : Rectangle{l.x - capital, l.x, l.y - l.width, l.y});
    }
    for (size_t a = 0; a < boxes.size(); ++a)
      for (size_t b = 0; b < a; ++b) {
        const bool apart = boxes[a].right <= boxes[b].left || boxes[b].right <= boxes[a].left || boxes[a].bottom <= boxes[b].top ||
                           boxes[b].bottom <= boxes[a].top;
        EXPECT_TRUE(apart) << labels[a].text << " | " << labels[b].text << " at width " << c.width;
      }
  }
}

TEST(Chart, SvgHasThePicturesSizeTextsAndMarks) {
  for (const Chart& c : crowded()) {
    const core::Picture p = draw(c);
    const std::string s = svg(c);
    EXPECT_NE(s.find("width=\"" + std::to_string(p.width) + "\" height=\"" + std::to_string(p.height) + "\""), std::string::npos);
    EXPECT_EQ(count(s, "<g"), count(s, "</g>"));
    EXPECT_EQ(count(s, "<text"), count(s, "</text>"));
    for (const Panel& panel : c.panels)
      for (const Series& one : panel.series) EXPECT_NE(s.find(">" + one.name), std::string::npos);
    EXPECT_EQ(s, svg(c));
    EXPECT_EQ(p.rgb, draw(c).rgb);
  }
  Panel odd = panel({"a < b & \"c\"", {0, 1}, {0, 1}, {}, Mark::line, -1});
  const std::string s = svg(chart_of({odd}));
  EXPECT_NE(s.find("a &lt; b &amp; &quot;c&quot;"), std::string::npos);
  EXPECT_NE(s.find(">height (m)<"), std::string::npos);
  EXPECT_NE(s.find(">0.5<"), std::string::npos);
}

TEST(Chart, PanelsWithOneXLabelShareItsRangeAndTexts) {
  Panel a = panel({"", {0, 1000}, {0, 1}, {}, Mark::line, 0}), b = panel({"", {400, 600}, {0, 1}, {}, Mark::line, 1});
  const core::Picture p = draw(chart_of({a, b}));
  const Found upper = find(p, bluish), lower = find(p, reddish);
  const double left = (lower.left - upper.left) / static_cast<double>(upper.right - upper.left);
  EXPECT_NEAR(left, 0.4, 0.02);
  EXPECT_EQ(count(svg(chart_of({a, b})), ">time (s)<"), 1u);
  b.x_label = "distance (m)";
  const Found own = find(draw(chart_of({a, b})), reddish);
  EXPECT_LT(own.left, upper.left + 10);
}

TEST(Chart, ALogarithmicPanelLeavesOutWhatItCannotShow) {
  Panel p = panel({"", ramp(7, 0, 6), {1e-3, 1e-2, 0.0, -1.0, 1.0, 10.0, 100.0}, {}, Mark::line, 0});
  p.log_y = true;
  const std::string s = svg(chart_of({p}));
  for (const char* text : {">0.001<", ">0.1<", ">10<"}) EXPECT_NE(s.find(text), std::string::npos) << text;
}

TEST(Chart, FarValuesNeedNotFlattenTheRest) {
  std::vector<double> values(1001, 0.0);
  for (size_t k = 0; k < values.size(); ++k) values[k] = std::sin(0.1 * static_cast<double>(k));
  values[500] = 1e6;
  const Reach r = middle_reach(values, 0.98, false);
  EXPECT_NEAR(r.low, -1.0, 1e-3);
  EXPECT_NEAR(r.high, 2.0, 1e-2);
  EXPECT_DOUBLE_EQ(middle_reach({1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, 0.8, false).high, 10.0);  // no far value: all of them
  EXPECT_NEAR(middle_reach({0.0, -3.0, 1e-9, 1, 1, 1, 2, 2, 2, 4, 4, 4, 4, 4, 1e9}, 0.7, true).high, 8.0, 1e-9);

  Panel p = panel({"", ramp(1001, 0, 100), values, {}, Mark::line, 1});
  p.y_share = 0.98;
  Series mark{"", {50}, {1e6}, {}, Mark::dots, 0};
  p.series.push_back(mark);
  const Chart chart = chart_of({p});
  EXPECT_NE(svg(chart).find("Height (2 values beyond the frame)"), std::string::npos);
  const core::Picture picture = draw(chart);
  const Found plot = rim(picture), dot = find(picture, bluish), line = find(picture, reddish);
  EXPECT_GT(line.bottom - line.top, (plot.bottom - plot.top) / 2);
  EXPECT_LE(dot.top, plot.top + 3);  // the far dot stands at the frame
  EXPECT_GT(dot.n, 3);
}

TEST(Chart, KindsStandSideBySideUnderTheirNames) {
  Panel p = panel({"", {0, 2}, {1, 1}, {}, Mark::dots, 0});
  p.x_names = {"line 3", "line 7", "line 12"};
  const std::string s = svg(chart_of({p}));
  for (const char* name : {">line 3<", ">line 7<", ">line 12<"}) EXPECT_EQ(count(s, name), 1u) << name;
  EXPECT_EQ(s.find(">0.5<"), s.rfind(">0.5<")) << "no numbers along x";
  const core::Picture picture = draw(chart_of({p}));
  const Found plot = rim(picture), dots = find(picture, bluish);
  const double width = plot.right - plot.left;
  EXPECT_NEAR((dots.left - plot.left) / width, 1.0 / 6.0, 0.02);
  EXPECT_NEAR((dots.right - plot.left) / width, 5.0 / 6.0, 0.02);
}

TEST(Chart, ColoursOfAnyIndexDifferForThreeRounds) {
  std::set<core::Rgb> seen;
  for (int k = 0; k < 21; ++k) seen.insert(palette(k));
  EXPECT_EQ(seen.size(), 21u);
  EXPECT_EQ(palette(21), palette(0));
}

TEST(Chart, ColumnsOfDifferentLengthAreRefused) {
  EXPECT_THROW(draw(chart_of({panel({"s", {0, 1, 2}, {0, 1}, {}, Mark::line, -1})})), core::Error);
  EXPECT_THROW(svg(chart_of({panel({"s", {0, 1}, {0, 1}, {1}, Mark::band, -1})})), core::Error);
}

}  // namespace
}  // namespace swath::report
