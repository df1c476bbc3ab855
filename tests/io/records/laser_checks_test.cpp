// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/laser_checks.h"

#include <cmath>
#include <string>
#include <vector>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

class LaserChecks : public ::testing::Test {
 protected:
  LaserChecks() {
    LaserFile& f = survey_.laser.emplace_back();
    f.file = folder_ / "a.csv";
    f.time = {core::TimeScale::gps, {}, ""};
    f.angle_unit = AngleUnit::deg;
    f.columns.time = "t";
    f.columns.range = "r";
    f.columns.scan_angle = "a";
    f.columns.line = "line";
    survey_.line_time.scale = core::TimeScale::gps;
    survey_.lines = {{1, "", core::Seconds(0), core::Seconds(100)}, {2, "", core::Seconds(200), core::Seconds(300)}};
  }
  /// Records once a second: line 1 as long as stated, line 2 until `last`; a swath of `half` deg, ranges about `range` m.
  std::string counted(double half, double range, int last = 300) {
    std::string rows = "t,line,r,a\n";
    for (int t = 0; t <= last; ++t)
      if (t <= 100 || t >= 200)
        rows += std::to_string(t) + (t <= 100 ? ",1," : ",2,") + std::to_string(range + t % 7) + "," + std::to_string(half * std::sin(t)) +
                "\n";
    test::write_bytes(folder_ / "a.csv", rows);
    core::Tally tally;
    check_laser(survey_, scan(survey_, tally), tally);
    std::string names;
    const core::Value all = tally.value();
    for (const auto& [what, entry] : all.members()) names += what + "\n";
    return names;
  }
  test::TemporaryFolder folder_;
  Survey survey_;
};

TEST_F(LaserChecks, RightRecordsSayNothing) {
  EXPECT_EQ(counted(20, 350), "");
  EXPECT_EQ(counted(0.003, 350), "") << "a mirror that is parked";
}

TEST_F(LaserChecks, RadiansReadAsDegreesAreCounted) { EXPECT_NE(counted(0.35, 350).find("radians stated as degrees"), std::string::npos); }

TEST_F(LaserChecks, AMomentOfASweepIsNotCalledRadians) {
  std::string rows = "t,line,r,a\n";
  for (int i = 0; i < 200; ++i) rows += std::to_string(10 + 0.002 * i) + ",1,350," + std::to_string(0.35 * std::sin(0.1 * i)) + "\n";
  test::write_bytes(folder_ / "a.csv", rows);
  core::Tally tally;
  check_laser(survey_, scan(survey_, tally), tally);
  EXPECT_EQ(tally.value().find("flight lines whose scan angles are tiny: radians stated as degrees?"), nullptr);
}

TEST_F(LaserChecks, CommonTimesAreThoseWithTheLatencyAdded) {
  const std::vector<StripInfo> strips = [&] {
    counted(20, 350);
    core::Tally tally;
    return scan(survey_, tally);
  }();
  EXPECT_NO_THROW(hold_common_times(survey_, strips, {290, 320}));
  EXPECT_THROW(hold_common_times(survey_, strips, {305, 320}), core::Error);
  survey_.calibration.latency = core::Seconds(18);
  EXPECT_NO_THROW(hold_common_times(survey_, strips, {305, 320}));
  EXPECT_THROW(hold_common_times(survey_, strips, {0, 10}), core::Error);
}

TEST_F(LaserChecks, RangesOfNoSurveyAreCounted) {
  EXPECT_NE(counted(20, 35000).find("range_unit"), std::string::npos);
  EXPECT_EQ(counted(20, 8000), "");
}

TEST_F(LaserChecks, WholeNumbersAreNoRanges) {
  const auto counted_with = [&](double step, const char* unit_of) {
    std::string rows = "t,line,r,a\n";
    for (int t = 0; t <= 300; ++t)
      rows += std::to_string(0.3 * t) + ",1," + std::to_string(350 + step * (t % 40)) + "," + std::to_string(20 * std::sin(t)) + "\n";
    test::write_bytes(folder_ / "a.csv", rows);
    survey_.laser.front().range_unit = core::Metres(std::stod(unit_of));
    core::Tally tally;
    check_laser(survey_, scan(survey_, tally), tally);
    return tally.of("flight lines whose ranges are whole numbers of coarse units: another column read as columns.range?");
  };
  EXPECT_EQ(counted_with(1, "1"), 1u);
  EXPECT_EQ(counted_with(0.25, "1"), 0u);
  EXPECT_EQ(counted_with(1, "0.001"), 0u) << "millimetres";
}

}  // namespace
}  // namespace swath::io
