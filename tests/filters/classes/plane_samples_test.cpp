// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/plane_samples.h"

#include <gtest/gtest.h>

#include <set>

#include "filters/bins.h"
#include "tests/world/scene.h"

namespace swath::filters {
namespace {

core::Block field(double spacing) {
  core::Block b;
  for (double y = 0.5 * spacing; y < 60.0; y += spacing)
    for (double x = 0.5 * spacing; x < 60.0; x += spacing) test::add_point(b, x, y, 0.1 * x);
  return b;
}

TEST(PlaneSamples, CellsAreAsWideAsTheReturnsAreApart) {
  for (const auto& [spacing, side] :
       {std::pair{0.25, 1.0}, std::pair{0.5, 1.0}, std::pair{0.75, 1.5}, std::pair{1.0, 2.0}, std::pair{3.0, 3.0}}) {
    const core::Block b = field(spacing);
    const Districts d = districts(b);
    EXPECT_EQ(sample_sides[d.side_at(30.0, 30.0)], side) << spacing;
  }
}

TEST(PlaneSamples, AVoidDoesNotMakeCellsWide) {
  core::Block b = field(0.5);
  std::vector<std::uint32_t> rows;
  for (std::uint32_t p = 0; p < b.size(); ++p)
    if (b.x[p] < 26.0 || b.x[p] > 34.0) rows.push_back(p);
  const Districts d = districts(core::select(b, rows));
  EXPECT_EQ(sample_sides[d.side_at(30.0, 30.0)], 1.0);
}

TEST(PlaneSamples, AtMostFourOfEachCellInAnyOrder) {
  const core::Block b = field(0.25);
  std::vector<std::uint32_t> rows;
  const core::Block other = test::shuffled(b, 7, rows);
  const Samples one(b, lattice_around(b, 1.0, 0)), two(other, lattice_around(other, 1.0, 0));
  ASSERT_EQ(one.lattice(), two.lattice());
  for (int j = 0; j < one.lattice().ny; ++j)
    for (int i = 0; i < one.lattice().nx; ++i) {
      ASSERT_EQ(one.in(i, j).size(), two.in(i, j).size());
      EXPECT_LE(one.in(i, j).size(), samples_of_cell);
      for (size_t k = 0; k < one.in(i, j).size(); ++k) EXPECT_EQ(one.in(i, j)[k].row, rows[two.in(i, j)[k].row]);
    }
}

TEST(PlaneSamples, NoiseIsNoSample) {
  core::Block b = field(2.0);
  core::add_columns(b, {core::Column::classification});
  b.classification.assign(b.size(), core::point_class::high_noise);
  const Samples none(b, lattice_around(b, 1.0, 0));
  for (int j = 0; j < none.lattice().ny; ++j)
    for (int i = 0; i < none.lattice().nx; ++i) EXPECT_TRUE(none.in(i, j).empty());
}

}  // namespace
}  // namespace swath::filters
