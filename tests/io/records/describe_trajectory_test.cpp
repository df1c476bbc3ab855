// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/describe_trajectory.h"

#include <cmath>

#include "core/config/units.h"
#include "core/time.h"
#include "io/records/sbet.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

bool warns(const core::Value& told, const std::string& words) {
  for (const core::Value& w : told.find("warnings")->items())
    if (w.as_text().find(words) != std::string::npos) return true;
  return false;
}

/// Four seconds north at 60 m/s, 100 Hz.
core::TrajectoryData north() {
  core::TrajectoryData t;
  for (int i = 0; i < 400; ++i) {
    t.time.push_back(core::from_week(2000, 100 + 0.01 * i));
    t.latitude.push_back(0.8 + 0.01 * i * 60 / 6.37e6);
    t.longitude.push_back(0.2);
    t.height.push_back(500);
    for (auto* c : {&t.roll, &t.pitch, &t.heading}) c->push_back(0.01);
    for (auto* c : {&t.sigma_north, &t.sigma_east, &t.sigma_down, &t.sigma_roll, &t.sigma_pitch, &t.sigma_heading}) c->push_back(0.02f);
  }
  return t;
}

class DescribeTrajectory : public ::testing::Test {
 protected:
  /// Writes the flight with one stored field multiplied in every record.
  std::filesystem::path scaled(std::initializer_list<size_t> fields, double factor, double shift = 0) {
    write_sbet(folder_ / "a.out", north());
    std::string bytes = test::read_bytes(folder_ / "a.out");
    for (size_t i = 0; i < bytes.size() / sbet_bytes; ++i)
      for (const size_t f : fields) {
        auto* at = reinterpret_cast<unsigned char*>(bytes.data()) + i * sbet_bytes + 8 * f;
        store(at, load<double>(at) * factor + shift);
      }
    test::write_bytes(folder_ / "a.out", bytes);
    return folder_ / "a.out";
  }
  test::TemporaryFolder folder_;
};

TEST_F(DescribeTrajectory, ASoundSbet) {
  const auto file = scaled({}, 1);
  EXPECT_TRUE(looks_like_sbet(file));
  EXPECT_FALSE(looks_like_smrmsg(file));
  const core::Value told = describe_sbet(file);
  EXPECT_EQ(told.find("records")->as_int(), 400);
  EXPECT_NEAR(told.find("rate_hz")->as_number(), 100, 1e-3);
  EXPECT_NEAR(told.find("mean_speed_m_s")->as_number(), 60, 1);
  EXPECT_EQ(told.find("warnings")->items().size(), 1u);  // seconds of which week
}

TEST_F(DescribeTrajectory, WhatLooksWrongIsToldOf) {
  auto file = scaled({1, 2, 7, 8, 9}, 180 / core::pi);
  EXPECT_TRUE(looks_like_sbet(file));
  EXPECT_TRUE(warns(describe_sbet(file), "degrees"));
  EXPECT_TRUE(warns(describe_sbet(scaled({9}, 1, 2)), "differs from the track"));
  EXPECT_TRUE(warns(describe_sbet(scaled({4}, 3)), "velocities disagree"));
  EXPECT_TRUE(warns(describe_sbet(scaled({7}, 150)), "attitudes in degrees"));
  EXPECT_TRUE(warns(describe_sbet(scaled({0}, -1, 1e6)), "goes back"));
  EXPECT_TRUE(warns(describe_sbet(scaled({0}, 0, 5)), "repeat"));
  core::TrajectoryData gap = north();
  for (size_t i = 200; i < 400; ++i) gap.time[i] += 7;
  write_sbet(folder_ / "gap.out", gap);
  EXPECT_TRUE(warns(describe_sbet(folder_ / "gap.out"), "1 gap, the longest 7.01 s"));
}

TEST_F(DescribeTrajectory, Accuracies) {
  write_smrmsg(folder_ / "acc.out", north());
  EXPECT_TRUE(looks_like_smrmsg(folder_ / "acc.out"));
  const core::Value told = describe_smrmsg(folder_ / "acc.out");
  EXPECT_NEAR(told.find("sigma_down_m")->items()[1].as_number(), 0.02, 1e-6);
  EXPECT_NEAR(told.find("sigma_heading_deg")->items()[0].as_number(), 0.02 / core::degree, 1e-4);
}

TEST(DescribeTrajectoryReference, RealFiles) {
  SWATH_SHARED_OR_SKIP(data, "data");
  EXPECT_TRUE(looks_like_sbet(data / "als_leeward/sbet.out"));
  const core::Value told = describe_sbet(data / "als_leeward/sbet.out");
  EXPECT_EQ(told.find("records")->as_int(), 200);
  EXPECT_EQ(told.find("velocity_axes")->as_text(), "north, west, up");
  EXPECT_NEAR(told.find("heading_minus_track_deg")->as_number(), 5.5, 0.3);
  EXPECT_FALSE(looks_like_sbet(data / "optech_csd/sample.csd"));
}

}  // namespace
}  // namespace swath::io
