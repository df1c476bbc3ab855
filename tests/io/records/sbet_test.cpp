// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/sbet.h"

#include <cmath>

#include "core/error.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

using core::TrajectoryData;
const TimeTags week_2317{core::TimeScale::gps_week, 2317, ""};
constexpr double rounding = 1e-12;  // of angles after a way through wrap and back, rad

/// Two seconds of straight flight, 50 m/s north and 20 m/s east, rising 1 m/s, at 100 Hz.
TrajectoryData straight() {
  TrajectoryData t;
  for (int i = 0; i < 200; ++i) {
    const double s = 0.01 * i, lat = 0.8;
    t.time.push_back(core::from_week(2317, 1000.0) + s);
    t.latitude.push_back(lat + 50 * s / (core::meridian_radius(lat) + 900));
    t.longitude.push_back(0.2 + 20 * s / ((core::prime_vertical_radius(lat) + 900) * std::cos(lat)));
    t.height.push_back(900 + s);
    t.roll.push_back(0.01);
    t.pitch.push_back(-0.02);
    t.heading.push_back(6.0);
    t.v_north.push_back(50);
    t.v_east.push_back(20);
    t.v_down.push_back(-1);
    t.sigma_north.push_back(0.01f + 0.0001f * static_cast<float>(i));
    t.sigma_east.push_back(0.02f);
    t.sigma_down.push_back(0.03f);
    t.sigma_roll.push_back(4e-5f);
    t.sigma_pitch.push_back(5e-5f);
    t.sigma_heading.push_back(1e-4f);
  }
  return t;
}

class Sbet : public ::testing::Test {
 protected:
  Sbet() { write_sbet(file_, straight()); }
  std::filesystem::path with(size_t record, size_t field, double value) {
    std::string bytes = test::read_bytes(file_);
    store(reinterpret_cast<unsigned char*>(bytes.data()) + record * sbet_bytes + 8 * field, value);
    test::write_bytes(folder_ / "changed.out", bytes);
    return folder_ / "changed.out";
  }
  TrajectoryData read(const std::filesystem::path& file, VelocityAxes axes = VelocityAxes::automatic, bool wander = true) {
    return read_sbet(file, week_2317, wander, axes, std::nullopt, tally_);
  }
  test::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_ / "a.out";
  core::Tally tally_;
};

TEST_F(Sbet, WrittenRecordsReadBack) {
  const TrajectoryData t = straight();
  write_smrmsg(folder_ / "acc.out", t);
  const TrajectoryData back = read_sbet(file_, week_2317, true, VelocityAxes::automatic, folder_ / "acc.out", tally_);
  EXPECT_EQ(back.time, t.time);
  EXPECT_EQ(back.latitude, t.latitude);
  EXPECT_EQ(back.v_east, t.v_east);
  EXPECT_EQ(back.v_down, t.v_down);
  EXPECT_NEAR(back.heading[7], 6.0, rounding);
  EXPECT_NEAR(back.sigma_north[100], t.sigma_north[100], 1e-8);
  EXPECT_NEAR(back.sigma_heading[3], 1e-4, 1e-10);
  EXPECT_EQ(tally_.of("SBET files with velocities north, west, up"), 1u);
}

TEST_F(Sbet, VelocitySigmasComeFromTheCovariances) {
  TrajectoryData t = straight();
  core::CovarianceSeries::Matrix9 m = core::CovarianceSeries::Matrix9::Identity() * 1e-6;
  for (int k = 0; k < 3; ++k) m(3 + k, 3 + k) = 1e-4 * (k + 1);
  t.covariance.time = {t.time.front(), t.time.back()};
  t.covariance.upper = {core::CovarianceSeries::pack(m), core::CovarianceSeries::pack(4.0 * m)};
  write_smrmsg(folder_ / "acc.out", t);
  std::vector<SmrmsgRecord> rows;
  SmrmsgFile(folder_ / "acc.out").read(0, t.size(), rows);
  constexpr double float_rounding = 1e-7;
  for (size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(rows.front().velocity[k], 0.01 * std::sqrt(static_cast<double>(k + 1)), float_rounding);
    EXPECT_NEAR(rows.back().velocity[k], 0.02 * std::sqrt(static_cast<double>(k + 1)), float_rounding);
  }
  t.covariance = {};
  write_smrmsg(folder_ / "acc.out", t);
  SmrmsgFile(folder_ / "acc.out").read(0, 1, rows);
  EXPECT_EQ(rows.front().velocity[0], 0.0);
}

TEST_F(Sbet, VelocitiesAreMadeWhereTheTrajectoryHasNone) {
  TrajectoryData t = straight();
  t.v_north.clear();
  t.v_east.clear();
  t.v_down.clear();
  write_sbet(file_, t);
  const TrajectoryData back = read(file_);
  EXPECT_NEAR(back.v_north[100], 50, 1e-4);
  EXPECT_NEAR(back.v_east[100], 20, 1e-2);  // the made flight keeps its radius at the first latitude
}

TEST_F(Sbet, WanderTurnsHeadingAndVelocities) {
  const double wander = 0.3;
  std::string bytes = test::read_bytes(file_);
  for (size_t i = 0; i < 200; ++i) {
    auto* r = reinterpret_cast<unsigned char*>(bytes.data()) + i * sbet_bytes;
    store(r + 8 * 4, 50 * std::cos(wander) - 20 * std::sin(wander));     // along azimuth -wander
    store(r + 8 * 5, -(50 * std::sin(wander) + 20 * std::cos(wander)));  // to its left
    store(r + 8 * 9, 6.0 + wander);
    store(r + 8 * 10, wander);
  }
  test::write_bytes(file_, bytes);
  const TrajectoryData t = read(file_);
  EXPECT_NEAR(t.heading[0], 6.0, rounding);
  ASSERT_TRUE(t.has_velocity());
  EXPECT_NEAR(t.v_north[5], 50, 1e-9);
  EXPECT_NEAR(t.v_east[5], 20, 1e-9);
  EXPECT_NEAR(read(file_, VelocityAxes::ignore, false).heading[0], 6.0 + wander - 2 * core::pi, rounding);
}

TEST_F(Sbet, VelocitiesThatDisagreeAreNotUsed) {
  std::string bytes = test::read_bytes(file_);
  for (size_t i = 0; i < 200; ++i) store(reinterpret_cast<unsigned char*>(bytes.data()) + i * sbet_bytes + 32, -50.0);
  test::write_bytes(file_, bytes);
  EXPECT_FALSE(read(file_).has_velocity());
  EXPECT_EQ(tally_.of("SBET velocities that disagree with the positions, not used"), 200u);
  EXPECT_TRUE(read(file_, VelocityAxes::ned).has_velocity());
}

TEST_F(Sbet, EveryTruncationNamesItsByte) {
  const std::string bytes = test::read_bytes(file_);
  for (size_t n = 0; n < 3 * sbet_bytes; ++n) {
    test::write_bytes(folder_ / "cut.out", bytes.substr(0, n));
    if (n > 0 && n % sbet_bytes == 0) {
      EXPECT_EQ(read(folder_ / "cut.out", VelocityAxes::ignore).size(), n / sbet_bytes);
      continue;
    }
    try {
      read(folder_ / "cut.out");
      FAIL() << n;
    } catch (const core::Error& e) {
      if (n > 0) {
        EXPECT_NE(e.where().find("byte " + std::to_string(n)), std::string::npos) << e.text();
      }
    }
  }
}

TEST_F(Sbet, BadValuesNameTheRecord) {
  for (const auto& [record, field, value] :
       {std::tuple<size_t, size_t, double>{17, 1, NAN}, {3, 0, INFINITY}, {199, 9, NAN}, {5, 1, 47.9}, {60, 0, 1e9}, {70, 3, 1e9}}) {
    tally_ = {};
    EXPECT_EQ(read(with(record, field, value)).size(), 199u) << record;
    EXPECT_EQ(tally_.left_out(), 1u) << record;
  }
  std::string bytes = test::read_bytes(file_);
  for (size_t i = 10; i < 200; i += 20) store(reinterpret_cast<unsigned char*>(bytes.data()) + i * sbet_bytes + 8 * 3, std::nan(""));
  test::write_bytes(folder_ / "many.out", bytes);
  try {
    read(folder_ / "many.out");
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(e.where().find("record 10"), std::string::npos) << e.text();
  }
  EXPECT_THROW(read_sbet(file_, TimeTags{}, true, VelocityAxes::ignore, std::nullopt, tally_), core::Error);
}

TEST_F(Sbet, AccuraciesOutsideTheirSpanAreCounted) {
  TrajectoryData part = straight();
  for (auto* c : {&part.sigma_north, &part.sigma_east, &part.sigma_down, &part.sigma_roll, &part.sigma_pitch, &part.sigma_heading})
    c->resize(100);
  part.time.resize(100);
  write_smrmsg(folder_ / "acc.out", part);
  const TrajectoryData t = read_sbet(file_, week_2317, true, VelocityAxes::ignore, folder_ / "acc.out", tally_);
  EXPECT_EQ(tally_.of("trajectory records outside the smrmsg's span (nearest sigma used)"), 100u);
  EXPECT_EQ(t.sigma_north[199], t.sigma_north[99]);
  EXPECT_THROW(read_sbet(file_, week_2317, true, VelocityAxes::ignore, file_, tally_), core::Error);
}

TEST(SbetReference, RealFiles) {
  SWATH_SHARED_OR_SKIP(data, "data");
  core::Tally tally;
  const TrajectoryData a =
      read_sbet(data / "als_leeward/sbet.out", {core::TimeScale::gps_week, 1900, ""}, true, VelocityAxes::automatic, std::nullopt, tally);
  EXPECT_EQ(a.size(), 200u);
  EXPECT_EQ(tally.of("SBET files with velocities north, west, up"), 1u);
  EXPECT_NEAR(a.v_north[0], -102.63, 0.05);
  EXPECT_NEAR(a.heading[0], 2.879948 - 0.017832, 1e-5);
  const TrajectoryData b = read_sbet(data / "tiny_survey/truth/sbet.out", week_2317, true, VelocityAxes::automatic, std::nullopt, tally);
  EXPECT_EQ(b.size(), 6181u);
  EXPECT_EQ(tally.of("SBET files with velocities north, east, down"), 1u);
  EXPECT_EQ(b.time[0], 2317 * 604800.0 + 474006.0017);
}

}  // namespace
}  // namespace swath::io
