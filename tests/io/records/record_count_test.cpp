// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/record_count.h"

#include "core/error.h"
#include "io/las/las_writer.h"
#include "io/text/npy.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

TEST(RecordCount, IsThatOfTheHeaderWhateverTheNameIs) {
  const test::TemporaryFolder folder;
  LasWriteOptions o;
  o.threads = 1;
  LasWriter cloud(folder / "cloud.las", o);
  cloud.finish();
  std::filesystem::rename(folder / "cloud.las", folder / "cloud.dat");
  EXPECT_EQ(stated_records(folder / "cloud.dat"), 0u);
  {
    NpyWriter writer(folder / "a.npy", {{"t", "f8"}});
    const std::vector<double> times{1.0, 2.0, 3.0};
    writer.append({times.data()}, times.size());
    writer.commit();
  }
  EXPECT_EQ(stated_records(folder / "a.npy"), 3u);
  test::write_bytes(folder / "a.csv", "time,range\n1,2\n");
  EXPECT_FALSE(stated_records(folder / "a.csv").has_value());
  test::write_bytes(folder / "empty", "");
  EXPECT_FALSE(stated_records(folder / "empty").has_value());
  EXPECT_THROW(stated_records(folder / "none"), core::Error);
}

}  // namespace
}  // namespace swath::io
