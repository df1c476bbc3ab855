// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/text_rows.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

TEST(TextRows, WritesRowsWholeOrNotAtAll) {
  const test::TemporaryFolder folder;
  {
    TextRows rows(folder / "a.csv", "x,y,z\n");
    rows.number(1.23456, 2);
    rows.scientific(-1234.5, 3);
    rows.shortest(0.1);
    rows.end();
    rows.number(7, 0);
    rows.end();
    rows.commit();
    TextRows lost(folder / "b.csv", "x\n");
    lost.number(1, 0);
    lost.end();
  }
  EXPECT_EQ(test::read_bytes(folder / "a.csv"), "x,y,z\n1.23,-1.234e+03,0.1\n7\n");
  EXPECT_EQ(test::entries(folder.path()), 1u);
}

TEST(TextRows, RefusesAFolderThatIsAFile) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "file", "x");
  EXPECT_THROW(TextRows(folder / "file" / "a.csv", "x\n"), core::Error);
}

TEST(TextRows, TimesGetTheDecimalsTheyNeed) {
  EXPECT_EQ(decimals_of(474000.0, 0.2, 3), 3);
  EXPECT_EQ(decimals_of(604795.25, 0.005, 4), 4);
  EXPECT_EQ(decimals_of(474000.0, 1.0 / 3, 3), 9);
  EXPECT_EQ(decimals_of(407106.003323, 0.2, 3), 9);
}

}  // namespace
}  // namespace swath::io
