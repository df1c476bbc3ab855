// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/canvas.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::report {
namespace {

constexpr core::Rgb black{0, 0, 0};
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Drawing sheet(int width, int height, std::function<void(Canvas&)> paint) { return {width, height, std::move(paint)}; }

/// How much ink is on the picture, in pixels.
double ink(const core::Picture& p) {
  double sum = 0.0;
  for (const std::uint8_t c : p.rgb) sum += (255 - c) / (3.0 * 255.0);
  return sum;
}

double line_ink(const std::vector<double>& x, const std::vector<double>& y, double width, double opacity = 1.0) {
  return ink(draw(sheet(60, 60, [&](Canvas& c) { c.line(x, y, width, black, opacity); })));
}

TEST(Canvas, ALineCoversLengthTimesWidth) {
  constexpr double rounding = 0.02;  // of the ink: pixels have 256 steps
  EXPECT_NEAR(line_ink({10, 50}, {20.5, 20.5}, 1.0), 40.0, 40.0 * rounding);
  EXPECT_NEAR(line_ink({10, 40}, {10, 50}, 3.0), 150.0, 150.0 * rounding);
  EXPECT_NEAR(line_ink({10, 50}, {20, 20}, 2.0, 0.25), 20.0, 20.0 * rounding);
  EXPECT_NEAR(line_ink({10, 20, nan, 40, 50}, {20, 20, nan, 20, 20}, 2.0), 40.0, 40.0 * rounding);
  EXPECT_EQ(line_ink({nan, nan}, {1, 2}, 2.0), 0.0);
  EXPECT_NEAR(line_ink({-1e300, 1e300}, {20, 20}, 2.0), 120.0, 120.0 * rounding);
}

TEST(Canvas, ALineDoesNotDarkenWhereItMeetsItself) {
  const double there = line_ink({10, 50}, {20, 20}, 2.0, 0.5);
  EXPECT_NEAR(line_ink({10, 50, 10}, {20, 20, 20}, 2.0, 0.5), there, 2.0);
}

TEST(Canvas, NothingIsDrawnOutsideTheClip) {
  const core::Picture p = draw(sheet(60, 60, [](Canvas& c) {
    c.clip(Box{20, 20, 10, 10});
    c.line({0, 60}, {0, 60}, 5.0, black);
    c.dots({20}, {20}, 6.0, black);
    c.clip(std::nullopt);
    c.fill({50, 50, 3, 3}, black);
  }));
  int inside = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 60; ++x) {
      const bool box = x >= 20 && x < 30 && y >= 20 && y < 30, later = x >= 50 && x < 53 && y >= 50 && y < 53;
      if (!box && !later) {
        EXPECT_EQ(*p.at(x, y), 255) << x << ", " << y;
      }
      inside += box && *p.at(x, y) < 255;
    }
  EXPECT_GT(inside, 30);
  EXPECT_EQ(*p.at(51, 51), 0);
}

TEST(Canvas, DotsAreDiscsAndFramesAreOnePixelWide) {
  const double discs = ink(draw(sheet(60, 60, [](Canvas& c) { c.dots({15, 40, nan}, {15, 40, 3}, 6.0, black); })));
  EXPECT_NEAR(discs, 2.0 * 36.0 * 3.14159, 4.0);
  const core::Picture p = draw(sheet(60, 60, [](Canvas& c) { c.frame({10, 10, 20, 30}, black); }));
  EXPECT_NEAR(ink(p), 2 * 20 + 2 * 28, 1e-9);
  EXPECT_EQ(*p.at(10, 10), 0);
  EXPECT_EQ(*p.at(29, 39), 0);
}

TEST(Canvas, PixelsAreTheirColoursInBands) {
  const Drawing d = sheet(40, 700, [](Canvas& c) {
    c.pixels({3, 5, 30, 690}, [](int x, int y) {
      return core::Rgb{static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y % 256), static_cast<std::uint8_t>(y / 256)};
    });
  });
  const core::Picture p = draw(d);
  for (const int y : {0, 255, 256, 300, 689}) {
    const std::uint8_t* c = p.at(3 + 7, 5 + y);
    EXPECT_EQ(c[0], 7);
    EXPECT_EQ(c[1] + 256 * c[2], y);
  }
  EXPECT_EQ(*p.at(2, 100), 255);
  EXPECT_EQ(*p.at(10, 4), 255);
  EXPECT_EQ(*p.at(33, 100), 255);
}

/// The box of everything that is not white.
Box inked(const core::Picture& p) {
  int left = p.width, right = -1, top = p.height, bottom = -1;
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x)
      if (*p.at(x, y) < 200) {
        left = std::min(left, x);
        right = std::max(right, x);
        top = std::min(top, y);
        bottom = std::max(bottom, y);
      }
  return {left, top, right - left + 1, bottom - top + 1};
}

TEST(Canvas, TextIsAsWideAsMeasuredAndLiesAroundItsAnchor) {
  const std::string text = "HHHHHHHH";
  const double width = text_width(text, 20.0);
  EXPECT_NEAR(text_width(text, 40.0), 2.0 * width, 1e-9);
  EXPECT_GT(text_width(text, 20.0, true), width);
  EXPECT_EQ(text_width("", 20.0), 0.0);
  for (const Anchor anchor : {Anchor::start, Anchor::middle, Anchor::end}) {
    const double start = anchor == Anchor::start ? 200.0 : anchor == Anchor::middle ? 200.0 - width / 2 : 200.0 - width;
    const Box level = inked(draw(sheet(400, 400, [&](Canvas& c) { c.text(200, 200, text, {.size = 20.0, .anchor = anchor}); })));
    EXPECT_NEAR(level.x, start, 4.0);
    EXPECT_NEAR(level.width, width, 5.0);
    EXPECT_NEAR(level.y + level.height / 2.0, 200.0, 1.1);  // capitals
    const Box turned =
        inked(draw(sheet(400, 400, [&](Canvas& c) { c.text(200, 200, text, {.size = 20.0, .anchor = anchor, .angle = upward}); })));
    EXPECT_NEAR(turned.x + turned.width / 2.0, 200.0, 1.1);
    EXPECT_NEAR(400.0 - turned.y - turned.height, start, 4.0);
  }
  const Box small = inked(draw(sheet(400, 400, [&](Canvas& c) { c.text(0, 200, text, {.size = 20.0, .room = 50.0}); })));
  EXPECT_LE(small.width, 50);
  EXPECT_GT(small.width, 40);
}

TEST(Canvas, AHaloSurroundsItsText) {
  const auto blue_around = [](std::optional<core::Rgb> halo) {
    const core::Picture p = draw(sheet(100, 40, [&](Canvas& c) { c.text(20, 20, "125", {.size = 20.0, .colour = black, .halo = halo}); }));
    int n = 0;
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 100; ++x) n += p.at(x, y)[2] > 200 && p.at(x, y)[0] < 60;
    return n;
  };
  EXPECT_EQ(blue_around(std::nullopt), 0);
  EXPECT_GT(blue_around(core::Rgb{0, 0, 255}), 100);
}

/// Everything at once, with texts that files have to take as they are.
Drawing everything() {
  return sheet(300, 200, [](Canvas& c) {
    c.clip(Box{10, 10, 100, 100});
    c.line({10, 100}, {10, 100}, 2.0, {200, 0, 0}, 0.5);
    c.area({10, 50, 90}, {20, 30, 20}, {60, 60, 60}, {0, 0, 200}, 0.25);
    c.clip(std::nullopt);
    c.pixels({120, 10, 40, 40}, [](int x, int y) {
      return core::Rgb{static_cast<std::uint8_t>(6 * x), static_cast<std::uint8_t>(6 * y), 0};
    });
    c.text(20, 150, "a < b & \"c\" Überhöhe \xff\x01", {.size = 14.0});
    c.text(200, 150, "range (m)", {.size = 14.0, .angle = upward});
  });
}

TEST(Canvas, TheSameDrawingGivesTheSameBytes) {
  const std::string first = svg(everything()), page = pdf(everything());
  draw(everything());  // Cairo has counted surfaces since
  EXPECT_EQ(svg(everything()), first);
  EXPECT_EQ(pdf(everything()), page);
  EXPECT_EQ(draw(everything()).rgb, draw(everything()).rgb);
}

TEST(Canvas, SvgIsSelfContainedWithTextsThatCanBeFound) {
  const std::string s = svg(everything());
  EXPECT_TRUE(s.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\"")) << s.substr(0, 200);
  EXPECT_NE(s.find("width=\"300\" height=\"200\""), std::string::npos);
  EXPECT_NE(s.find(">a &lt; b &amp; &quot;c&quot; Überhöhe \uFFFD <"), std::string::npos);
  EXPECT_NE(s.find("rotate(-90)\">range (m)<"), std::string::npos);
  EXPECT_EQ(s.find("<script"), std::string::npos);
  for (size_t at = s.find("href=\""); at != std::string::npos; at = s.find("href=\"", at + 1))
    EXPECT_TRUE(s.compare(at + 6, 1, "#") == 0 || s.compare(at + 6, 22, "data:image/png;base64,") == 0) << s.substr(at, 40);
  EXPECT_TRUE(svg(Drawing()).empty());
}

TEST(Canvas, PdfHasOnePageWithItsTypefaceAndNoDate) {
  const std::string s = pdf(everything());
  EXPECT_TRUE(s.starts_with("%PDF-"));
  EXPECT_NE(s.find("/Count 1"), std::string::npos);
  EXPECT_NE(s.find("/MediaBox [ 0 0 225 150 ]"), std::string::npos) << "300 x 200 pixels are 225 x 150 points";
  EXPECT_NE(s.find("/FontFile"), std::string::npos);
  EXPECT_EQ(s.find("Date"), std::string::npos);
  EXPECT_TRUE(pdf(Drawing()).empty());
}

TEST(Canvas, APictureTooLargeForCairoIsAnError) {
  const Drawing d = sheet(40000, 10, [](Canvas&) {});
  EXPECT_THROW(draw(d), core::Error);
  EXPECT_EQ(draw(Drawing()).width, 0);
}

/// In a process of its own, because fontconfig reads its settings once.
TEST(CanvasDeathTest, WithoutTypefacesTextsAreStillDrawn) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  const auto draw_without_typefaces = [] {
    const test::TemporaryFolder folder;
    const std::string settings = (folder / "fonts.conf").string();
    std::ofstream(settings) << "<?xml version=\"1.0\"?><fontconfig><dir>" << folder.path().string() << "</dir></fontconfig>";
    setenv("FONTCONFIG_FILE", settings.c_str(), 1);
    const Drawing d = sheet(200, 40, [](Canvas& c) { c.text(10, 20, "height 12.5 m", {.size = 14.0}); });
    const bool drawn = ink(draw(d)) > 50.0 && text_width("height 12.5 m", 14.0) > 50.0;
    std::_Exit(drawn && svg(d).find(">height 12.5 m<") != std::string::npos && pdf(d).starts_with("%PDF") ? 0 : 1);
  };
  EXPECT_EXIT(draw_without_typefaces(), testing::ExitedWithCode(0), "");
}

TEST(Canvas, EqualTextsOfTwoSizesKeepTheirWidthsInProportion) {
  for (const char* text : {"-0.25", "time since 474000 s (s)", "日本", "\xc3"})
    EXPECT_NEAR(text_width(text, 13.0) / text_width(text, 26.0), 0.5, 1e-9) << text;
}

}  // namespace
}  // namespace swath::report
