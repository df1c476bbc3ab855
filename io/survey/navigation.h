// SPDX-License-Identifier: GPL-3.0-or-later
// The part of survey.toml that a trajectory is computed from: IMU and GNSS records, events and clocks.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/records/imu_spec.h"
#include "core/records/sensor.h"
#include "io/survey/time_tags.h"

namespace swath::io {

enum class RecordFormat { automatic, text, npy };
enum class ImuKind { unstated, increments, rates };
/// What a record of rates stands for.
enum class ImuSample {
  mean,     ///< the mean over the interval since the record before
  instant,  ///< the value at the time stamp
};
/// Which instant of its interval a record's time names.
enum class ImuStamp { end, middle, start };
enum class AccelerationUnit { unstated, mps2, g, mg };

struct ImuColumns {
  std::string time, week, gyro_x, gyro_y, gyro_z, accelerometer_x, accelerometer_y, accelerometer_z;
};

template <class V>
void describe(ImuColumns& c, V& v) {
  v.option("time", c.time, "Time of the record.");
  v.option("week", c.week, "GPS week of the record, where it has a column of its own.");
  v.option("gyro_x", c.gyro_x, "Angular rate, or angle, about the sensor's x axis.");
  v.option("gyro_y", c.gyro_y, "About y.");
  v.option("gyro_z", c.gyro_z, "About z.");
  v.option("accelerometer_x", c.accelerometer_x, "Specific force, or velocity, along the sensor's x axis.");
  v.option("accelerometer_y", c.accelerometer_y, "Along y.");
  v.option("accelerometer_z", c.accelerometer_z, "Along z.");
}

/// One file of IMU records.
struct ImuFile {
  std::filesystem::path file;
  RecordFormat format = RecordFormat::automatic;
  TimeTags time;
  ImuKind kind = ImuKind::unstated;
  AngleUnit angle_unit = AngleUnit::unstated;
  AccelerationUnit acceleration_unit = AccelerationUnit::unstated;
  double gyro_factor = 1.0, accelerometer_factor = 1.0;
  ImuSample sample = ImuSample::mean;
  ImuStamp stamp = ImuStamp::end;
  bool even_times = true;
  std::optional<core::Hertz> rate;
  std::array<std::string, 3> axes{"x", "y", "z"};
  core::Radians roll, pitch, heading;
  std::string delimiter;
  ImuColumns columns;
};

template <class V>
void describe(ImuFile& f, V& v) {
  v.option("file", f.file, "File, relative to survey.toml.");
  v.option("format", f.format, "Format; automatic goes by the name's ending (.csv .txt: text; .npy: NumPy structured array).");
  v.table("time", f.time, "Time scale.");
  v.option("kind", f.kind, "Increments over an interval (angle, velocity), or rates (angular rate, specific force).");
  v.option("angle_unit", f.angle_unit, "Unit of angles; of rates: that unit per second.");
  v.option("acceleration_unit", f.acceleration_unit, "Unit of specific force; of increments: that unit times seconds.");
  v.option("gyro_factor", f.gyro_factor, core::above(0), "Units per recorded number of the gyros, for raw counts.");
  v.option("accelerometer_factor", f.accelerometer_factor, core::above(0), "Units per recorded number of the accelerometers.");
  v.option("sample", f.sample, "Rates: the mean since the record before, or the value at the instant.");
  v.option("stamp", f.stamp, "Which instant of the record's interval its time names.");
  v.option("even_times", f.even_times, "Smooth times that jitter by over 1 % of the step, over 101 records; false: keep them.");
  v.option("rate", f.rate, core::within(1, 1e4), "Records per second; without it from the median step.");
  v.option("axes", f.axes, "Axes of the record that point forward, right and down (x, y, z, -x, -y, -z), before the mounting.");
  v.option("roll", f.roll, core::one_turn(),
           "Mounting: the rotation sensor to body after `axes`, body_R_sensor = Rz(heading) Ry(pitch) Rx(roll).");
  v.option("pitch", f.pitch, core::one_turn(), "Pitch of the mounting.");
  v.option("heading", f.heading, core::one_turn(), "Heading of the mounting.");
  v.option("delimiter", f.delimiter, "Delimiter of a text file; empty: found in its first line.");
  v.table("columns", f.columns, "Columns of a text or NumPy file.");
}

enum class GnssFormat { automatic, text, pos, nmea };

struct GnssColumns {
  std::string time, week, latitude, longitude, height, x, y, z;
  std::string cov_xx, cov_xy, cov_xz, cov_yy, cov_yz, cov_zz;
  std::string sigma_north, sigma_east, sigma_up;
  std::string v_north, v_east, v_up, sigma_v_north, sigma_v_east, sigma_v_up;
  std::string quality, satellites;
};

template <class V>
void describe(GnssColumns& c, V& v) {
  v.option("time", c.time, "Time of the fix.");
  v.option("week", c.week, "GPS week of the fix, where it has a column of its own.");
  v.option("latitude", c.latitude, "Geodetic latitude.");
  v.option("longitude", c.longitude, "Longitude.");
  v.option("height", c.height, "Ellipsoidal height.");
  v.option("x", c.x, "ECEF x, m, in place of latitude, longitude and height.");
  v.option("y", c.y, "ECEF y.");
  v.option("z", c.z, "ECEF z.");
  v.option("cov_xx", c.cov_xx, "Covariance of the position in ECEF, m^2 (all six).");
  v.option("cov_xy", c.cov_xy, "Covariance of x and y.");
  v.option("cov_xz", c.cov_xz, "Covariance of x and z.");
  v.option("cov_yy", c.cov_yy, "Variance of y.");
  v.option("cov_yz", c.cov_yz, "Covariance of y and z.");
  v.option("cov_zz", c.cov_zz, "Variance of z.");
  v.option("sigma_north", c.sigma_north, "Sigma of north, m.");
  v.option("sigma_east", c.sigma_east, "Sigma of east, m.");
  v.option("sigma_up", c.sigma_up, "Sigma of height, m.");
  v.option("v_north", c.v_north, "Velocity north, m/s.");
  v.option("v_east", c.v_east, "Velocity east.");
  v.option("v_up", c.v_up, "Velocity up.");
  v.option("sigma_v_north", c.sigma_v_north, "Sigma of the velocity north, m/s.");
  v.option("sigma_v_east", c.sigma_v_east, "Sigma of the velocity east.");
  v.option("sigma_v_up", c.sigma_v_up, "Sigma of the velocity up.");
  v.option("quality", c.quality, "Kind of the solution, as RTKLIB numbers it (1 fixed, 2 float, 3 SBAS, 4 DGPS, 5 single, 6 PPP).");
  v.option("satellites", c.satellites, "Number of satellites.");
}

/// One file of antenna positions.
struct GnssFile {
  std::filesystem::path file;
  GnssFormat format = GnssFormat::automatic;
  TimeTags time;
  AngleUnit angle_unit = AngleUnit::deg;
  bool geoid_height = false;
  std::optional<std::array<core::Metres, 3>> base;
  std::string delimiter;
  GnssColumns columns;
  core::Metres sigma_horizontal{0.02}, sigma_vertical{0.04};
  core::MetresPerSecond sigma_velocity{0.05};
};

template <class V>
void describe(GnssFile& f, V& v) {
  v.option("file", f.file, "File, relative to survey.toml.");
  v.option("format", f.format, "Format; automatic goes by the name's ending (.pos: RTKLIB; .nmea .log: NMEA; .csv .txt: text).");
  v.table("time", f.time, "Time scale (text); RTKLIB files and NMEA state their own, NMEA may need `date`; `offset` acts on all.");
  v.option("angle_unit", f.angle_unit, "Unit of latitude and longitude in a text file.");
  v.option("geoid_height", f.geoid_height, "RTKLIB: heights were written above the geoid; refused, since swath does not know that geoid.");
  v.option("base", f.base, "RTKLIB files of baselines (e/n/u): ECEF position of the base.");
  v.option("delimiter", f.delimiter, "Delimiter of a text file; empty: found in its first line.");
  v.table("columns", f.columns, "Columns of a text file.");
  v.option("sigma_horizontal", f.sigma_horizontal, core::above(0),
           "Sigma of north and of east, where the file states none: of fixed solutions and of those of unknown kind; others have at least "
           "0.1 m (PPP), 0.3 m (float), 1 m (differential, SBAS), 3 m (single).");
  v.option("sigma_vertical", f.sigma_vertical, core::above(0),
           "Sigma of height where the file states none; not fixed: at least twice sigma_horizontal's.");
  v.option("sigma_velocity", f.sigma_velocity, core::above(0), "Sigma of each velocity component, where the file states none.");
}

/// The GNSS antenna on its carrier.
struct Antenna {
  std::array<core::Metres, 3> lever_arm{};
  core::Metres lever_arm_sigma{0.02};
  core::Seconds latency;
};

template <class V>
void describe(Antenna& a, V& v) {
  v.option("lever_arm", a.lever_arm, "IMU centre to the antenna's phase centre: forward, right, down.", "conventions");
  v.option("lever_arm_sigma", a.lever_arm_sigma, core::at_least(0), "Sigma of each component.");
  v.option("latency", a.latency, "Added to every fix's time.");
}

/// A GNSS base station for raw observations.
struct BaseStation {
  std::string name;
  std::vector<std::filesystem::path> observations;
  std::optional<std::array<core::Metres, 3>> position;
  std::optional<std::array<core::Metres, 3>> antenna_offset;
  std::string antenna_type;
};

template <class V>
void describe(BaseStation& b, V& v) {
  v.option("name", b.name, "Name for reports.");
  v.option("observations", b.observations, "RINEX observation files.");
  v.option("position", b.position, "ECEF position of the marker; without it the RINEX header's approximate position, with a warning.");
  v.option("antenna_offset", b.antenna_offset, "Marker to the antenna's reference point: east, north, up; without it the RINEX header's.");
  v.option("antenna_type", b.antenna_type, "Antenna type as in the antenna file; empty: none; \"*\": the RINEX header's.");
}

/// Raw GNSS observations.
struct Rinex {
  std::vector<std::filesystem::path> rover, navigation;
  std::vector<BaseStation> bases;
  std::optional<std::filesystem::path> antenna_file;
  std::string antenna_type;
  std::array<core::Metres, 3> antenna_offset{};
};

template <class V>
void describe(Rinex& r, V& v) {
  v.option("rover", r.rover, "RINEX observation files of the aircraft.");
  v.option("navigation", r.navigation, "RINEX navigation files; beside them precise orbits (SP3) and clocks.");
  v.tables("base", r.bases, "Base stations.");
  v.option("antenna_file", r.antenna_file, "Phase centre file (ANTEX) for both ends.");
  v.option("antenna_type", r.antenna_type, "The rover's antenna type; empty: none; \"*\": the RINEX header's.");
  v.option("antenna_offset", r.antenna_offset, "East, north, up from the wanted point to the rover's antenna; zero for an aircraft.");
}

enum class ClockFormat { loopstats, peerstats, pps };

/// A log that shows how far a computer's clock stood from UTC.
struct ClockLog {
  std::filesystem::path file;
  ClockFormat format = ClockFormat::loopstats;
};

template <class V>
void describe(ClockLog& c, V& v) {
  v.option("file", c.file, "File, relative to survey.toml.");
  v.option("format", c.format, "loopstats and peerstats of ntpd (offset = reference - clock), or a log of PPS pulses.");
}

struct EventColumns {
  std::string time, id, strip;
};

template <class V>
void describe(EventColumns& c, V& v) {
  v.option("time", c.time, "Time of the event.");
  v.option("id", c.id, "Name or number of the event; without it they are counted from 1.");
  v.option("strip", c.strip, "Strip the event belongs to.");
}

enum class EventFormat { automatic, text, rinex, mrk, ubx, novatel };
enum class EventEdge { rising, falling };

/// One file of events: camera exposures, pulses.
struct EventFile {
  std::filesystem::path file;
  EventFormat format = EventFormat::automatic;
  EventEdge edge = EventEdge::rising;
  int input = 0;
  std::string technique;
  TimeTags time;
  bool computer_clock = false;
  core::Seconds latency;
  std::string delimiter;
  EventColumns columns;
};

template <class V>
void describe(EventFile& e, V& v) {
  v.option("file", e.file, "File of events, relative to survey.toml.");
  v.option("format", e.format, "Format; automatic: by the name's ending and the first bytes.");
  v.option("edge", e.edge, "Edge of the pulse that is the event (ubx).");
  v.option("input", e.input, core::within(0, 4), "Input of the receiver, from 1 (ubx, novatel); 0: all.");
  v.option("technique", e.technique, "Name of the technique that timed them (\"pc\", \"marks\"), for comparisons.");
  v.table("time", e.time, "Time scale.");
  v.option("computer_clock", e.computer_clock, "Times are of the computer's clock and are corrected by [[clock]].");
  v.option("latency", e.latency, "Added to every time.");
  v.option("delimiter", e.delimiter, "Delimiter; empty: found in the first line.");
  v.table("columns", e.columns, "Columns.");
}

}  // namespace swath::io

namespace swath::core {
template <>
struct Choices<io::RecordFormat> {
  static constexpr std::array<std::string_view, 3> names{"automatic", "text", "npy"};
};
template <>
struct Choices<io::ImuKind> {
  static constexpr std::array<std::string_view, 3> names{"unstated", "increments", "rates"};
};
template <>
struct Choices<io::ImuSample> {
  static constexpr std::array<std::string_view, 2> names{"mean", "instant"};
};
template <>
struct Choices<io::ImuStamp> {
  static constexpr std::array<std::string_view, 3> names{"end", "middle", "start"};
};
template <>
struct Choices<io::AccelerationUnit> {
  static constexpr std::array<std::string_view, 4> names{"unstated", "m/s2", "g", "mg"};
};
template <>
struct Choices<io::GnssFormat> {
  static constexpr std::array<std::string_view, 4> names{"automatic", "text", "pos", "nmea"};
};
template <>
struct Choices<io::EventFormat> {
  static constexpr std::array<std::string_view, 6> names{"automatic", "text", "rinex", "mrk", "ubx", "novatel"};
};
template <>
struct Choices<io::EventEdge> {
  static constexpr std::array<std::string_view, 2> names{"rising", "falling"};
};
template <>
struct Choices<io::ClockFormat> {
  static constexpr std::array<std::string_view, 3> names{"loopstats", "peerstats", "pps"};
};
}  // namespace swath::core
