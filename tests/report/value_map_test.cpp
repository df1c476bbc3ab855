// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/value_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace swath::report {
namespace {

constexpr float unknown = std::numeric_limits<float>::quiet_NaN();

int darkness(const core::Picture& p, int x, int y) {
  const std::uint8_t* c = p.at(x, y);
  return 3 * 255 - c[0] - c[1] - c[2];
}

/// West pale, east dark, a line across, and a void.
TEST(ValueMap, MoreIsDarker) {
  const core::Lattice l{10.0, 0, 0, 40, 30};
  std::vector<float> v(l.size());
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) v[l.at(i, j)] = j < 3 ? unknown : static_cast<float>(i);
  ValueMapOptions o;
  o.title = "density";
  const Drawing plain = value_map(l, v, {}, o), lined = value_map(l, v, {{{0, 400}, {150, 150}, 3.0, "line 1"}}, o);
  const core::Picture p = draw(plain), q = draw(lined);
  ASSERT_EQ(p.width, q.width);
  // The map begins at the margin, below the title: rows of the map found by the line's own row.
  int changed = 0, row = -1;
  for (int y = 0; y < p.height; ++y)
    if (darkness(q, p.width / 2, y) > darkness(p, p.width / 2, y) + 100) {
      ++changed;
      row = y;
    }
  EXPECT_GE(changed, 2);
  EXPECT_LE(changed, 5);
  EXPECT_LT(darkness(p, 60, row), darkness(p, p.width / 2, row));
  EXPECT_LT(darkness(p, p.width / 2, row), darkness(p, p.width - 60, row));
}

TEST(ValueMap, NothingIsAnEmptyPicture) {
  EXPECT_EQ(value_map({}, {}, {}, {}).width, 0);
  const core::Lattice l{10.0, 0, 0, 4, 4};
  EXPECT_GT(value_map(l, std::vector<float>(16, unknown), {}, {}).width, 0);
  EXPECT_GT(draw(value_map(l, std::vector<float>(16, 2.5f), {}, {})).width, 0);
}

}  // namespace
}  // namespace swath::report
