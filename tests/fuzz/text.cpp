// SPDX-License-Identifier: GPL-3.0-or-later
// Delimited text: laser, IMU, trajectory and GNSS records, events and control, all of the same columns.
#include "io/gnss/gnss_file.h"
#include "io/records/event_file.h"
#include "io/records/imu_file.h"
#include "io/records/trajectory_file.h"
#include "io/survey/info.h"
#include "io/vector/control.h"
#include "tests/fuzz/target.h"

using namespace swath;

namespace {

constexpr const char* tables = R"(
[[laser]]
file = "records.txt"
angle_unit = "deg"
time = { scale = "gps_week", week = 2317 }
columns = { time = "1", scan_angle = "2", range = "3" }
[[imu]]
file = "records.txt"
kind = "increments"
angle_unit = "rad"
acceleration_unit = "m/s2"
time = { scale = "gps_week", week = 2317 }
columns = { time = "1", gyro_x = "2", gyro_y = "3", gyro_z = "4", accelerometer_x = "5", accelerometer_y = "6", accelerometer_z = "7" }
[[trajectory]]
file = "records.txt"
angle_unit = "deg"
time = { scale = "gps_week", week = 2317 }
columns = { time = "1", latitude = "2", longitude = "3", height = "4", roll = "5", pitch = "6", heading = "7" }
[[gnss]]
file = "records.txt"
time = { scale = "utc_day", date = "2024-06-03" }
columns = { time = "1", latitude = "2", longitude = "3", height = "4", sigma_north = "5", sigma_east = "6", sigma_up = "7" }
[[event]]
file = "records.txt"
technique = "pc"
time = { scale = "unix" }
columns = { time = "1", id = "2", strip = "3" }
[[control]]
file = "records.txt"
name = "1"
x = "2"
y = "3"
z = "4"
)";

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::given("records.txt", data, size);
  static const io::Survey survey = fuzz::survey_of(tables);
  core::Tally tally;
  fuzz::reading([&] { fuzz::read_shots(survey); });
  fuzz::reading([&] { fuzz::expect_sound(io::read_imu(survey, tally)); });
  fuzz::reading([&] { fuzz::expect_sound(io::read_trajectory(survey, tally)); });
  fuzz::reading([&] { fuzz::expect_sound(io::read_gnss(survey, tally)); });
  fuzz::reading([&] {
    for (const double t : io::events_of(io::read_event_files(survey, tally)).time) fuzz::expect(t, 1e11, "the time of an event");
  });
  fuzz::reading([&] {
    for (const io::ControlPoint& p : io::read_control(survey, tally)) fuzz::expect(p.ecef.norm(), 2e9, "a control point");
  });
  fuzz::reading([&] { io::info_text(io::describe_file(file)); });
  return 0;
}
