// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/table_rows.h"

#include <cmath>

#include "core/error.h"
#include "io/text/npy.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

TEST(TableRows, TextAndNumpyGiveTheSameRows) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.csv", "# made\nt,x,y\n1,2,3\n4,,6\n");
  const double t[2] = {1, 4}, x[2] = {2, std::nan("")}, y[2] = {3, 6};
  NpyWriter w(folder / "a.npy", {{"t", "f8"}, {"x", "f8"}, {"y", "f8"}});
  w.append({t, x, y}, 2);
  w.commit();
  for (const auto& [format, name, place] :
       {std::tuple{RecordFormat::text, "a.csv", "a.csv:4"}, {RecordFormat::npy, "a.npy", "a.npy: record 1"}}) {
    const auto rows = open_table(folder / name, format, "", {"y", "1", "x"});
    double v[3];
    ASSERT_TRUE(rows->next(v));
    EXPECT_EQ(v[0], 3);
    EXPECT_EQ(v[1], 1);
    EXPECT_EQ(v[2], 2);
    ASSERT_TRUE(rows->next(v));
    EXPECT_EQ(v[0], 6);
    EXPECT_TRUE(std::isnan(v[2]));
    EXPECT_NE(rows->place().find(place), std::string::npos) << rows->place();
    EXPECT_FALSE(rows->next(v));
    EXPECT_THROW(open_table(folder / name, format, "", {"t", "z"}), core::Error);
  }
  EXPECT_THROW(open_table(folder / "a.csv", RecordFormat::automatic, "", {"t"}), core::Error);
}

}  // namespace
}  // namespace swath::io
