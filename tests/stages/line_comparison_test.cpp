// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/line_comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "io/text/value_file.h"
#include "tests/world/support.h"

namespace swath::stages {
namespace {

TEST(LineComparison, CellsOfATileComeBack) {
  const test::TemporaryFolder folder;
  const quality::LineCells cells{{{0, 1, 2, 3, 4, 5, 0.1F, 0.01F}, {1, 1, 2, 3, 4, 7, 0.2F, 0.02F}}, {{0, 1, 2, 3, 9, 0.03F}}};
  write_line_cells(folder / "a.cells", cells);
  quality::LineCells back;
  read_line_cells(folder / "a.cells", back);
  EXPECT_EQ(back.differences, cells.differences);
  EXPECT_EQ(back.scatters, cells.scatters);
  read_line_cells(folder / "a.cells", back);
  EXPECT_EQ(back.differences.size(), 4u);
}

TEST(LineComparison, ADamagedFileIsAnError) {
  const test::TemporaryFolder folder;
  write_line_cells(folder / "a.cells", {{{0, 1, 2, 3, 4, 5, 0.1F, 0.01F}}, {}});
  const std::string bytes = test::read_bytes(folder / "a.cells");
  quality::LineCells back;
  for (const std::string& damaged : {bytes.substr(0, 5), bytes.substr(0, bytes.size() - 1), bytes + "x"}) {
    test::write_bytes(folder / "b.cells", damaged);
    EXPECT_THROW(read_line_cells(folder / "b.cells", back), core::Error);
  }
}

TEST(LineComparison, LaterStagesReadWhatAnEarlierOneWrote) {
  const test::TemporaryFolder folder;
  const io::Survey survey;
  Context context{survey};
  context.earlier = {folder.path()};
  EXPECT_FALSE(known_lines(context));
  quality::LineComparison c;
  c.lines = {{3, 1, 1, 0.05, 0.01}, {7, 1, 1, -0.05, 0.01}};
  c.scatter = 0.03;
  test::write_bytes(folder / "lines.json", io::to_json(core::reported(c)));
  const auto known = known_lines(context);
  ASSERT_TRUE(known);
  EXPECT_EQ(known->offsets.at(7), -0.05);
  EXPECT_TRUE(std::isnan(known->common));
  // Nothing compared: what neighbours share is taken to be as large as their scatter.
  EXPECT_NEAR(known->sigma(), std::sqrt(2.0) * 0.03, 1e-9);
  EXPECT_NEAR(known->horizontal_sigma(), std::sqrt(2.0) * 0.03, 1e-9);
  c.steep_places = 3;
  const auto of = [&](double common, double along) {
    c.common = common, c.common_horizontal = along;
    test::write_bytes(folder / "lines.json", io::to_json(core::reported(c)));
    return *known_lines(context);
  };
  EXPECT_NEAR(of(0.02, 0.05).shared(), 0.02, 1e-9);
  // Three steep places, and as a fourth that the place is as good as the height.
  EXPECT_NEAR(of(0.02, 0.05).horizontal_sigma(), std::sqrt(2.0 * (3 * 0.05 * 0.05 + 0.02 * 0.02) / 4), 1e-9);
  EXPECT_NEAR(of(0.02, std::nan("")).horizontal_sigma(), std::sqrt(2.0) * 0.02, 1e-9);  // no steep ground: as the heights

  core::Block b;
  b.z = {1.0, 2.0, 3.0};
  b.x = b.y = b.z;
  b.strip = {3, 7, 9};
  take_offsets(b, *known);
  EXPECT_EQ(b.z, (std::vector<double>{0.95, 2.05, 3.0}));
}

TEST(LineComparison, OnlyPointsWithoutASigmaGetOne) {
  core::Block b;
  b.x = b.y = b.z = {1.0, 2.0};
  EXPECT_EQ(give_sigmas(b, 0.03, 0.04), 2u);
  EXPECT_EQ(b.sigma_v, (std::vector<float>{0.03F, 0.03F}));
  EXPECT_EQ(b.sigma_h, (std::vector<float>{0.04F, 0.04F}));
  b.sigma_v = {0.0F, 0.1F};
  b.sigma_h = {0.0F, 0.2F};
  EXPECT_EQ(give_sigmas(b, 0.05, 0.06), 1u);
  EXPECT_EQ(b.sigma_v, (std::vector<float>{0.05F, 0.1F}));
  EXPECT_EQ(b.sigma_h, (std::vector<float>{0.06F, 0.2F}));
}

}  // namespace
}  // namespace swath::stages
