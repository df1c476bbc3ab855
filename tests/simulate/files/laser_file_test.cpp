// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/laser_file.h"

#include <gtest/gtest.h>

#include "tests/world/support.h"

namespace swath::simulate {
namespace {

TEST(LaserFile, TimesReadBackThroughTheirTags) {
  const core::GpsTime start = core::from_week(2317, 604799.5);  // the week ends during the records
  for (const core::TimeScale scale : {core::TimeScale::gps, core::TimeScale::gps_adjusted, core::TimeScale::gps_week,
                                      core::TimeScale::unix_utc, core::TimeScale::utc_day}) {
    const io::TimeTags tags = tags_of(scale, start);
    core::TimeReader reader(tags.scale, tags.week, tags.date, "made");
    for (double t = start; t < start + 3; t += 0.125) EXPECT_NEAR(reader(time_in(scale, t)), t, 1e-6);
  }
}

Returns made() {
  Returns r;
  for (int i = 0; i < 5; ++i) {
    for_each_column([&](auto column) { (r.*column).push_back(1.0); });
    const auto k = static_cast<size_t>(i);
    r.time[k] = core::from_week(2317, 1000.0 + i);
    r.angle[k] = 0.01 * i;
    r.forward[k] = 0.0;
    r.range[k] = 100 + i;
  }
  return r;
}

TEST(LaserFile, EveryFormatAppearsWithFinishOnly) {
  for (const Format f : {Format::csv, Format::npy, Format::las, Format::laz}) {
    const test::TemporaryFolder folder;
    const Options o;
    {
      auto file = open_laser_file(folder.path(), f, o);
      file->append(made());
    }
    EXPECT_EQ(test::entries(folder.path()), 0u);
    auto file = open_laser_file(folder.path(), f, o);
    file->append(made());
    file->append(made());
    file->finish();
    EXPECT_TRUE(std::filesystem::exists(folder.path() / laser_name(f)));
    EXPECT_EQ(test::entries(folder.path()), 1u);
  }
}

TEST(LaserFile, CsvHoldsDegreesAndMetres) {
  const test::TemporaryFolder folder;
  const Options o;
  auto file = open_laser_file(folder.path(), Format::csv, o);
  file->append(made());
  file->finish();
  const std::string text = test::read_bytes(folder / "laser.csv");
  EXPECT_EQ(text.find("time_s,line,scan_angle_deg,range_m,intensity,return_number,return_count\n1000,1,0.0000000,100.000000,1,1,1\n"), 0u)
      << text;
}

}  // namespace
}  // namespace swath::simulate
