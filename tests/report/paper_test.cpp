// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/paper.h"

#include <gtest/gtest.h>

#include <regex>

#include "core/error.h"
#include "report/chart.h"

namespace swath::report {
namespace {

std::ptrdiff_t pages_in(const std::string& pdf) {
  const std::regex page("/Type /Page[^s]");
  return std::distance(std::sregex_iterator(pdf.begin(), pdf.end(), page), std::sregex_iterator());
}

Table rows(size_t n, size_t columns = 3) {
  Table t;
  t.caption = "Many rows";
  for (size_t c = 0; c < columns; ++c) t.columns.push_back({"column with a long head " + std::to_string(c), c > 0});
  for (size_t r = 0; r < n; ++r) t.rows.push_back(std::vector<std::string>(columns, "1234.567"));
  return t;
}

TEST(Paper, AShortReportIsOneSheet) {
  Paper paper("Quality of a survey", "EPSG:32632");
  paper.banner(Tone::good, "All is met.");
  paper.section("Density");
  paper.paragraph("A sentence.");
  paper.list({"one", "two"});
  paper.table(rows(5));
  EXPECT_EQ(paper.sheets(), 1u);
  const std::string pdf = paper.pdf();
  EXPECT_TRUE(pdf.starts_with("%PDF-1.4"));
  EXPECT_EQ(pages_in(pdf), 1);
  EXPECT_EQ(paper.pdf(), pdf);
}

/// A sheet holds 1026 pixels, a row 14.7: 68 rows and the heads at most.
TEST(Paper, WhatDoesNotFitGoesOn) {
  Paper paper("T");
  paper.table(rows(200));
  EXPECT_GE(paper.sheets(), 3u);
  EXPECT_LE(paper.sheets(), 4u);
  EXPECT_EQ(pages_in(paper.pdf()), static_cast<std::ptrdiff_t>(paper.sheets()));
  Paper words("T");
  std::string text;
  for (int k = 0; k < 3000; ++k) text += "word ";
  words.paragraph(text);
  EXPECT_GE(words.sheets(), 2u);
}

/// Figures keep their shape within the sheet, and a tall one moves to the next.
TEST(Paper, FiguresAreScaledToTheSheet) {
  Paper paper("T");
  core::Picture picture(1600, 800, {200, 0, 0});
  paper.figure(picture, "Wide");  // 680 x 340
  paper.figure(picture, "Wide");
  EXPECT_EQ(paper.sheets(), 1u);
  paper.figure(picture, "Wide");
  EXPECT_EQ(paper.sheets(), 2u);
  Chart chart;
  Panel panel;
  panel.series = {{"one", {0, 1, 2}, {0, 1, 0}, {}, Mark::line, 0}};
  chart.panels = {panel};
  paper.figure(drawing(chart), "Chart");
  EXPECT_EQ(paper.sheets(), 2u);
  EXPECT_EQ(pages_in(paper.pdf()), 2);
}

TEST(Paper, AWideTableIsSetSmaller) {
  Paper paper("T");
  paper.table(rows(3, 30));
  EXPECT_EQ(paper.sheets(), 1u);
  EXPECT_EQ(pages_in(paper.pdf()), 1);
  Table t = rows(1);
  t.rows[0].push_back("too many");
  EXPECT_THROW(paper.table(t), core::Error);
}

}  // namespace
}  // namespace swath::report
