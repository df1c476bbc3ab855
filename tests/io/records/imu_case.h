// SPDX-License-Identifier: GPL-3.0-or-later
// Files of IMU records that tests make and read.
#pragma once

#include <cstdio>
#include <functional>
#include <string>

#include "core/error.h"
#include "io/records/imu_file.h"
#include "tests/world/support.h"

namespace swath::io {

inline constexpr double g = 9.81;
inline constexpr double place = 3e-7;  // s: one place of a GPS time and of the text

inline ImuFile rates_file(const std::filesystem::path& path) {
  ImuFile f;
  f.file = path;
  f.time = {core::TimeScale::gps_week, 2317, ""};
  f.kind = ImuKind::rates;
  f.angle_unit = AngleUnit::rad;
  f.acceleration_unit = AccelerationUnit::mps2;
  f.columns = {"t", "", "wx", "wy", "wz", "fx", "fy", "fz"};
  return f;
}

class ImuFiles : public ::testing::Test {
 protected:
  using Row = std::function<std::string(int)>;

  /// n records; `time(k)` in seconds of week, `values(k)` the six numbers.
  ImuFile made(int n, const std::function<double(int)>& time, const Row& values, const std::string& name = "imu.csv") {
    std::string text = "t,wx,wy,wz,fx,fy,fz\n";
    char t[32];
    for (int k = 0; k < n; ++k) {
      std::snprintf(t, sizeof t, "%.6f,", time(k));
      text += t + values(k) + "\n";
    }
    test::write_bytes(folder_ / name, text);
    return rates_file(folder_ / name);
  }
  core::ImuData read(const ImuFile& f) { return read_imu(survey_, f, tally_); }
  std::string refusal(const ImuFile& f) {
    try {
      read(f);
    } catch (const core::Error& e) {
      return e.text();
    }
    return "was read";
  }
  std::string example(const std::string& what) {
    const core::Value counts = tally_.value();
    const core::Value* one = counts.find(what);
    return one && one->find("examples") ? one->find("examples")->items()[0].as_text() : "";
  }

  static std::string level(int k) {
    return "0.01,0.02," + core::format_number(0.03 + 1e-6 * k) + ",0.1,0.2," + core::format_number(-g - 1e-6 * k);
  }
  static double at_100_hz(int k) { return 1000 + 0.01 * k; }

  test::TemporaryFolder folder_;
  Survey survey_;
  core::Tally tally_;
};

}  // namespace swath::io
