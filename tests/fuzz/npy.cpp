// SPDX-License-Identifier: GPL-3.0-or-later
// NumPy arrays: as such, as laser records and as IMU records.
#include "io/text/npy.h"

#include "io/records/imu_file.h"
#include "io/survey/info.h"
#include "tests/fuzz/target.h"

using namespace swath;

namespace {

constexpr const char* tables = R"(
[[laser]]
file = "records.npy"
angle_unit = "deg"
time = { scale = "gps_week", week = 2317 }
columns = { time = "1", scan_angle = "2", range = "3" }
[[laser]]
file = "records.npy"
time = { scale = "gps_week", week = 2317 }
columns = { time = "time", line = "line", x = "x", y = "y", z = "z", intensity = "intensity", return_number = "return_number" }
[[imu]]
file = "records.npy"
kind = "rates"
angle_unit = "deg"
acceleration_unit = "m/s2"
time = { scale = "gps_week", week = 2317 }
columns = { time = "1", gyro_x = "2", gyro_y = "3", gyro_z = "4", accelerometer_x = "5", accelerometer_y = "6", accelerometer_z = "7" }
)";

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::given("records.npy", data, size);
  static const io::Survey survey = fuzz::survey_of(tables);
  static const io::Survey one = [] {
    io::Survey s = survey;
    s.laser.resize(1);
    return s;
  }();
  static const io::Survey other = [] {
    io::Survey s = survey;
    s.laser.erase(s.laser.begin());
    return s;
  }();
  fuzz::reading([&] { io::describe_file(file); });
  fuzz::reading([&] { fuzz::read_shots(one); });
  fuzz::reading([&] { fuzz::read_shots(other); });
  fuzz::reading([&] {
    core::Tally tally;
    fuzz::expect_sound(io::read_imu(survey, tally));
  });
  return 0;
}
