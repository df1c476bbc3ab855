// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/line_comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "io/text/value_file.h"
#include "quality/line_offsets.h"
#include "stages/grid_tile.h"
#include "tests/world/support.h"

namespace swath::stages {
namespace {

TEST(LineComparison, CellsOfATileComeBack) {
  const test::TemporaryFolder folder;
  const quality::LineCells cells{{{0, 1, 2, 3, 4, 5, 0.1F, 0.01F}, {1, 1, 2, 3, 4, 7, 0.2F, 0.02F}}, {{0, 1, 2, 3, 9, 0.03F}}};
  write_rows(folder / "a.cells", cells.differences, cells.scatters);
  quality::LineCells back;
  read_rows(folder / "a.cells", back.differences, back.scatters);
  EXPECT_EQ(back.differences, cells.differences);
  EXPECT_EQ(back.scatters, cells.scatters);
  read_rows(folder / "a.cells", back.differences, back.scatters);
  EXPECT_EQ(back.differences.size(), 4u);
}

TEST(LineComparison, ADamagedFileIsAnError) {
  const test::TemporaryFolder folder;
  const quality::LineCells cells{{{0, 1, 2, 3, 4, 5, 0.1F, 0.01F}}, {}};
  write_rows(folder / "a.cells", cells.differences, cells.scatters);
  const std::string bytes = test::read_bytes(folder / "a.cells");
  quality::LineCells back;
  for (const std::string& damaged : {bytes.substr(0, 5), bytes.substr(0, bytes.size() - 1), bytes + "x"}) {
    test::write_bytes(folder / "b.cells", damaged);
    EXPECT_THROW(read_rows(folder / "b.cells", back.differences, back.scatters), core::Error);
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
  EXPECT_EQ(known->scatter, 0.03);
}

}  // namespace
}  // namespace swath::stages
