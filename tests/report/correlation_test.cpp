// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/correlation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "report/difference_map.h"

namespace swath::report {
namespace {

CorrelationChart three() {
  return {"Correlations", {"roll", "pitch & yaw", "range"}, {1.0, 0.25, -0.995, 0.25, 1.0, std::nan(""), -0.995, std::nan(""), 1.0}};
}

size_t occurrences(const std::string& text, const std::string& what) {
  size_t n = 0;
  for (size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

int pixels_of(const core::Picture& p, core::Rgb colour) {
  int n = 0;
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) n += std::equal(colour.begin(), colour.end(), p.at(x, y));
  return n;
}

TEST(Correlation, EveryCoefficientOfTheLowerTriangleStandsThereOnce) {
  const std::string s = svg(three());
  EXPECT_EQ(occurrences(s, ">0.25<"), 1u);
  EXPECT_EQ(occurrences(s, ">1<"), 3u);
  EXPECT_EQ(occurrences(s, ">-0.99<") + occurrences(s, ">-1.00<"), 1u);
  EXPECT_EQ(occurrences(s, ">pitch &amp; yaw<"), 2u);
  EXPECT_EQ(occurrences(s, ">nan<"), 0u);
}

TEST(Correlation, ColoursFollowTheCoefficients) {
  const core::Picture p = draw(three());
  // Three cells on the diagonal, one of the two others; letters take some pixels of each.
  const int cell = 64 * 32;
  EXPECT_GT(pixels_of(p, diverging_colour(1.0)), 2.5 * cell);
  EXPECT_LT(pixels_of(p, diverging_colour(1.0)), 3.0 * cell);
  EXPECT_GT(pixels_of(p, diverging_colour(-0.995)), 0.7 * cell);
  EXPECT_GT(pixels_of(p, diverging_colour(0.25)), 0.7 * cell);
}

TEST(Correlation, SizesThatDoNotFitAreRefused) {
  CorrelationChart c = three();
  c.values.pop_back();
  EXPECT_THROW(draw(c), core::Error);
  EXPECT_THROW(svg(c), core::Error);
}

}  // namespace
}  // namespace swath::report
