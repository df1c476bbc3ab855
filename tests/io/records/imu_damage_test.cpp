// SPDX-License-Identifier: GPL-3.0-or-later
// Records of an IMU that cannot be, stand out from all around them or are frozen.
#include <cmath>

#include "tests/io/records/imu_case.h"

namespace swath::io {
namespace {

TEST_F(ImuFiles, WhatIsDamagedIsLeftOutOrRefused) {
  const auto with = [&](int damaged, const std::string& row, double time_of_it) {
    return made(
        300, [&](int k) { return k == damaged ? time_of_it : at_100_hz(k); }, [&](int k) { return k == damaged ? row : level(k); });
  };
  core::ImuData imu = read(with(100, "nan,0,0,0,0,-9.81", at_100_hz(100)));
  EXPECT_EQ(imu.size(), 299u);
  EXPECT_EQ(tally_.of("IMU records with a value that is empty or not finite, left out"), 1u);
  EXPECT_NE(example("IMU records with a value that is empty or not finite, left out").find("imu.csv:102"), std::string::npos);
  EXPECT_EQ(tally_.of("IMU gaps"), 1u);
  imu = read(with(100, "0,0,0,0,,-9.81", at_100_hz(100)));
  EXPECT_EQ(imu.size(), 299u);

  tally_ = {};
  imu = read(with(100, level(99), at_100_hz(99)));
  EXPECT_EQ(imu.size(), 299u);
  EXPECT_EQ(tally_.of("IMU records at a repeated time, left out"), 1u);

  std::string text = refusal(with(100, level(100), at_100_hz(50)));
  EXPECT_NE(text.find("imu.csv:102: time goes back by 0.49"), std::string::npos) << text;
  text = refusal(with(100, "0,0,bad,0,0,-9.81", at_100_hz(100)));
  EXPECT_NE(text.find("imu.csv:102"), std::string::npos) << text;
  text = refusal(made(300, at_100_hz, [&](int k) { return k % 20 ? level(k) : "nan,0,0,0,0,0"; }));
  EXPECT_NE(text.find("15 of 300 IMU records"), std::string::npos) << text;
  text = refusal(made(
      300, [](int k) { return at_100_hz(k / 2); }, level));
  EXPECT_NE(text.find("150 of 300 IMU records are at the time"), std::string::npos) << text;
  EXPECT_NE(refusal(made(300, at_100_hz, [](int) { return "0,0,0,0,-9.81,0"; })).find("gravity is not along"), std::string::npos);
  EXPECT_NE(refusal(made(300, at_100_hz, [](int) { return "5,0,0,0,0,-9.81"; })).find("no vehicle"), std::string::npos);
  ImuFile f = made(300, at_100_hz, level);
  f.rate = core::Hertz(200);
  EXPECT_NE(refusal(f).find("the stated rate"), std::string::npos);
  f = rates_file(folder_ / "imu.csv");
  f.kind = ImuKind::unstated;
  EXPECT_NE(refusal(f).find("kind ="), std::string::npos);
  f = rates_file(folder_ / "imu.csv");
  f.columns.gyro_y = "wyy";
  EXPECT_NE(refusal(f).find("did you mean 'wy'"), std::string::npos);
}

TEST_F(ImuFiles, RatesStatedAsIncrementsAreNamedAtAnyRate) {
  for (const double rate : {50.0, 200.0, 2000.0}) {  // gravity as an increment is 490 to 19 620 m/s2
    ImuFile f = made(
        4000, [&](int k) { return 1000 + k / rate; }, level);
    f.kind = ImuKind::increments;
    const std::string text = refusal(f);
    EXPECT_NE(text.find("with kind = \"rates\" it would be 9.8"), std::string::npos) << rate << ": " << text;
  }
}

TEST_F(ImuFiles, ARecordThatStandsOutIsLeftOut) {
  const char* what = "IMU records that stand out from all around them, left out";
  for (const char* row : {"0.01,0.02,0.03,0.1,0.2,-98.1", "0.01,3,0.03,0.1,0.2,-9.81", "0.01,0.02,0.03,0.1,0.2,98.1"}) {
    tally_ = {};
    const core::ImuData imu = read(made(300, at_100_hz, [&](int k) { return k == 100 ? row : level(k); }));
    EXPECT_EQ(imu.size(), 299u) << row;
    EXPECT_EQ(tally_.of(what), 1u) << row;
    EXPECT_NE(example(what).find("imu.csv:102"), std::string::npos) << row;
    EXPECT_EQ(tally_.of("IMU gaps"), 1u) << row;
  }
  // What is not one record alone is motion: a shock with its swing, vibration with peaks, a step.
  const auto force = [](double f) { return "0.01,0.02,0.03,0.1,0.2," + core::format_number(f); };
  for (const Row& motion : std::vector<Row>{
           [&](int k) { return force(-g + (k < 100 ? 0.0 : 60.0 * std::exp(-0.1 * (k - 100)) * std::cos(1.5 * (k - 100)))); },
           [&](int k) { return force(-g + 15.0 * std::sin(2.1 * k) + (k % 37 == 0 ? 25.0 : 0.0)); },
           [&](int k) { return force(k < 5900 ? -g : -g + 30.0); }, [&](int k) { return force(-g + (k % 50 ? 0.0 : 30.0)); }}) {
    tally_ = {};
    EXPECT_EQ(read(made(6000, at_100_hz, motion)).size(), 6000u);
    EXPECT_EQ(tally_.of(what), 0u);
  }
}

// A gyro that stops for a second: what it says of the motion is wrong by its noise, and a gap of which the smoother knows is better.
TEST_F(ImuFiles, RecordsOfAFrozenAxisAreLeftOut) {
  const char* what = "IMU records in which an axis is frozen while others go on, left out";
  const auto noise = [](int k, double size) { return size * (std::fmod(0.5 + 0.618033988749895 * k * k, 1.0) - 0.5); };
  const auto row = [&](int k, bool frozen) {
    std::string out;
    for (int c = 0; c < 6; ++c) {
      const int at = frozen && c == 2 && k >= 500 && k < 600 ? 499 : k;
      out += (c ? "," : "") + core::format_number((c == 5 ? -g : 0.0) + noise(7 * at + c, c < 3 ? 1e-3 : 0.05));
    }
    return out;
  };
  EXPECT_EQ(read(made(1500, at_100_hz, [&](int k) { return row(k, false); })).size(), 1500u);
  EXPECT_EQ(tally_.of(what), 0u);
  const core::ImuData imu = read(made(1500, at_100_hz, [&](int k) { return row(k, true); }));
  EXPECT_EQ(imu.size(), 1400u);
  EXPECT_EQ(tally_.of(what), 100u);
  EXPECT_NE(example(what).find("imu.csv:502: gyro_z repeats one value for 1 s"), std::string::npos) << example(what);
  EXPECT_EQ(tally_.of("IMU gaps"), 1u);
  EXPECT_NEAR(imu.time[500] - imu.time[499], 1.01, place);
}

TEST_F(ImuFiles, AnAxisThatIsFrozenThroughoutIsRefused) {
  const auto noise = [](int k, double size) { return size * (std::fmod(0.5 + 0.618033988749895 * k * k, 1.0) - 0.5); };
  const auto row = [&](int k) {
    std::string out;
    for (int c = 0; c < 6; ++c)
      out += (c ? "," : "") + core::format_number(c == 1 ? 0.0123 : (c == 5 ? -g : 0.0) + noise(7 * k + c, c < 3 ? 1e-3 : 0.05));
    return out;
  };
  try {
    read(made(6500, at_100_hz, row));
    FAIL() << "a gyro that shows nothing of the motion";
  } catch (const core::Error& e) {
    EXPECT_EQ(std::string(e.what()), "gyro_y repeats one value throughout the file (0.0123) while other axes go on");
    EXPECT_NE(e.hint().find("columns of [[imu]]"), std::string::npos);
  }
}

TEST_F(ImuFiles, RecordsOfSeveralFrozenAxesAreCountedOnce) {
  const auto noise = [](int k, double size) { return size * (std::fmod(0.5 + 0.618033988749895 * k * k, 1.0) - 0.5); };
  const auto row = [&](int k) {
    std::string out;
    for (int c = 0; c < 6; ++c) {
      const int at = c < 3 && k >= 500 && k < 600 + 10 * c ? 499 : k;
      out += (c ? "," : "") + core::format_number((c == 5 ? -g : 0.0) + noise(7 * at + c, c < 3 ? 1e-3 : 0.05));
    }
    return out;
  };
  EXPECT_EQ(read(made(1500, at_100_hz, row)).size(), 1380u);
  EXPECT_EQ(tally_.of("IMU records in which an axis is frozen while others go on, left out"), 120u);
}

}  // namespace
}  // namespace swath::io
