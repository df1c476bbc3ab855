// SPDX-License-Identifier: GPL-3.0-or-later
// survey.toml: the files of a survey, their time scales, the mounting, the scanner, its calibration, the CRS, the lines.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/records/sensor.h"
#include "core/time.h"
#include "io/images/image_file.h"
#include "io/survey/breakline_file.h"
#include "io/survey/camera_file.h"
#include "io/survey/control_file.h"
#include "io/survey/navigation.h"
#include "io/survey/photo_files.h"
#include "io/survey/time_tags.h"

namespace swath::core {
class Crs;
}

namespace swath::io {

enum class LaserFormat { automatic, text, npy, las, csd };

/// Which column of a delimited file or field of a NumPy file holds what: a header name, or a number from 1.
struct LaserColumns {
  std::string time, week, line, scan_angle, range, intensity, return_number, return_count, x, y, z;
};

template <class V>
void describe(LaserColumns& c, V& v) {
  v.option("time", c.time, "Time of the record.");
  v.option("week", c.week, "GPS week of the record, where it has a column of its own.");
  v.option("line", c.line, "Flight line id.");
  v.option("scan_angle", c.scan_angle, "Scan angle, positive to starboard.");
  v.option("range", c.range, "Range.");
  v.option("intensity", c.intensity, "Intensity.");
  v.option("return_number", c.return_number, "Number of the return within its pulse, from 1.");
  v.option("return_count", c.return_count, "Returns of the pulse.");
  v.option("x", c.x, "Forward in the scanner frame, in place of range and angle.");
  v.option("y", c.y, "Right in the scanner frame.");
  v.option("z", c.z, "Nadir in the scanner frame.");
}

/// One file of raw laser records.
struct LaserFile {
  std::filesystem::path file;
  LaserFormat format = LaserFormat::automatic;
  TimeTags time;
  AngleUnit angle_unit = AngleUnit::unstated;
  core::Metres range_unit{1.0};
  bool angle_to_port = false;
  std::optional<int> line;
  std::optional<core::ScannerModel> model;
  std::string delimiter;
  LaserColumns columns;
};

template <class V>
void describe(LaserFile& f, V& v) {
  v.option("file", f.file, "File, relative to survey.toml.");
  v.option("format", f.format, "Format; automatic goes by the name's ending (.csv .txt .npy .las .laz .csd).");
  v.table("time", f.time, "Time scale.");
  v.option("angle_unit", f.angle_unit, "Unit of recorded angles (text and NumPy files).");
  v.option("range_unit", f.range_unit, core::above(0.0), "Length of one unit of recorded ranges (text and NumPy files).");
  v.option("angle_to_port", f.angle_to_port, "True where the file counts scan angles positive to port.");
  v.option("line", f.line, core::within(0, 65535), "Flight line id of all records, where the file has no column of lines.");
  v.option("model", f.model, "Scanner model of this file, where not scanner.model; only mirror, polygon and profile may be mixed.");
  v.option("delimiter", f.delimiter, "Delimiter of a text file; empty: comma, semicolon, tab or blanks, found in its first line.");
  v.table("columns", f.columns, "Columns of a text or NumPy file.");
}

enum class VelocityAxes { automatic, ned, nwu, ignore };
enum class TrajectoryFormat { automatic, sbet, text, csd };

struct TrajectoryColumns {
  std::string time, week, latitude, longitude, height, roll, pitch, heading, v_north, v_east, v_down;
  std::string sigma_north, sigma_east, sigma_down, sigma_roll, sigma_pitch, sigma_heading;
};

template <class V>
void describe(TrajectoryColumns& c, V& v) {
  v.option("time", c.time, "Time of the record.");
  v.option("week", c.week, "GPS week of the record, where it has a column of its own.");
  v.option("latitude", c.latitude, "Geodetic latitude (or northing, where the file has a projected CRS).");
  v.option("longitude", c.longitude, "Longitude (or easting).");
  v.option("height", c.height, "Ellipsoidal height.");
  v.option("roll", c.roll, "Roll, positive right wing down.");
  v.option("pitch", c.pitch, "Pitch, positive nose up.");
  v.option("heading", c.heading, "Heading from true north, clockwise.");
  v.option("v_north", c.v_north, "Velocity north.");
  v.option("v_east", c.v_east, "Velocity east.");
  v.option("v_down", c.v_down, "Velocity down.");
  v.option("sigma_north", c.sigma_north, "Sigma of the position, north.");
  v.option("sigma_east", c.sigma_east, "Sigma of the position, east.");
  v.option("sigma_down", c.sigma_down, "Sigma of the position, down.");
  v.option("sigma_roll", c.sigma_roll, "Sigma of roll, in the file's angle unit.");
  v.option("sigma_pitch", c.sigma_pitch, "Sigma of pitch.");
  v.option("sigma_heading", c.sigma_heading, "Sigma of heading.");
}

/// One trajectory file.
struct TrajectoryFile {
  std::filesystem::path file;
  TrajectoryFormat format = TrajectoryFormat::automatic;
  std::optional<std::filesystem::path> accuracy;
  TimeTags time;
  AngleUnit angle_unit = AngleUnit::unstated;
  bool wander = true;
  VelocityAxes velocity_axes = VelocityAxes::automatic;
  core::Seconds spacing{0.001};
  std::string crs;
  std::string delimiter;
  TrajectoryColumns columns;
  core::Metres sigma_horizontal{0.03}, sigma_vertical{0.05};
  core::Radians sigma_roll_pitch = core::degrees(0.003), sigma_heading = core::degrees(0.008);
};

template <class V>
void describe(TrajectoryFile& f, V& v) {
  v.option("file", f.file, "File, relative to survey.toml.");
  v.option("format", f.format, "Format; automatic goes by the name's ending (.out .sbet: SBET; .csv .txt .pos: text; .csd).");
  v.option("accuracy", f.accuracy, "smrmsg file with the SBET's standard deviations.");
  v.table("time", f.time, "Time scale.");
  v.option("angle_unit", f.angle_unit, "Unit of angles in a text file.");
  v.option("wander", f.wander, "SBET: subtract the wander angle from the platform heading.");
  v.option("velocity_axes", f.velocity_axes, "SBET: velocity axes: ned, nwu, automatic (those that agree with the positions) or ignore.");
  v.option("spacing", f.spacing, core::at_least(0), "CSD, which holds a pose per pulse: least time between two poses that are kept.");
  v.option("crs", f.crs,
           "CRS of a text file's horizontal coordinates where they are projected; empty: geodetic WGS84. Headings stay from true north.");
  v.option("delimiter", f.delimiter, "Delimiter of a text file; empty: found in its first line.");
  v.table("columns", f.columns, "Columns of a text file.");
  v.option("sigma_horizontal", f.sigma_horizontal, core::above(0), "Sigma of north and of east, where the file states none.");
  v.option("sigma_vertical", f.sigma_vertical, core::above(0), "Sigma of height, where the file states none.");
  v.option("sigma_roll_pitch", f.sigma_roll_pitch, core::above(0), "Sigma of roll and of pitch, where the file states none.");
  v.option("sigma_heading", f.sigma_heading, core::above(0), "Sigma of heading, where the file states none.");
}

/// One point cloud in map coordinates, entering after georeferencing.
struct PointFile {
  std::filesystem::path file;
  std::string crs;
  std::optional<core::Metres> height_unit;
  std::optional<int> line;
  core::TimeScale time_scale = core::TimeScale::unstated;
  std::optional<int> week;
  std::string date;
};

template <class V>
void describe(PointFile& f, V& v) {
  v.option("file", f.file, "LAS or LAZ file, relative to survey.toml.");
  v.option("crs", f.crs,
           "CRS of the file, where it states none, a wrong one or no heights: \"EPSG:25832+7837\", \"EPSG:25832+ellipsoidal\".");
  v.option("height_unit", f.height_unit, core::above(0.0),
           "One unit of the file's heights where its CRS has no vertical part; without it what the file states, then the survey's "
           "height_unit, then the unit of the file's horizontal axes.");
  v.option("line", f.line, core::within(0, 65535), "Flight line id of all points; otherwise the points' source ids.");
  v.option("time_scale", f.time_scale, "Scale of the file's times, where its GPS time bit is wrong; unstated: as that bit says.");
  v.option("week", f.week, core::within(0, 10000), "GPS week of the first point, for times in seconds of week; without it they are kept.");
  v.option("date", f.date, "UTC date of the first point, YYYY-MM-DD (time_scale utc_day).");
  v.check(f.time_scale != core::TimeScale::device, "the times of a point cloud cannot be on a device's own scale");
  v.check(f.time_scale != core::TimeScale::utc_day || !f.date.empty(), "time_scale utc_day needs the date of the first point");
}

/// Where the survey lies. What is not stated is not limited by it.
struct SurveyArea {
  std::optional<double> west, south, east, north;
  std::optional<core::Metres> lowest, highest;
};

template <class V>
void describe(SurveyArea& a, V& v) {
  v.option("west", a.west, "Western border, in units of the survey's CRS.");
  v.option("south", a.south, "Southern border.");
  v.option("east", a.east, "Eastern border.");
  v.option("north", a.north, "Northern border.");
  v.option("lowest", a.lowest, "Lowest height of a point, in the survey's height system.");
  v.option("highest", a.highest, "Highest height of a point.");
  v.check(!a.west || !a.east || *a.east > *a.west, "east must be larger than west");
  v.check(!a.south || !a.north || *a.north > *a.south, "north must be larger than south");
  v.check(!a.lowest || !a.highest || *a.highest > *a.lowest, "highest must be larger than lowest");
}

/// A stretch of the flight. Records outside every line are counted and left out.
struct FlightLine {
  int id = 1;
  std::string name;
  core::Seconds start, end;
};

template <class V>
void describe(FlightLine& l, V& v) {
  v.option("id", l.id, core::within(0, 65535), "Number of the line, the points' source id.");
  v.option("name", l.name, "Name for reports.");
  v.option("start", l.start, "First instant, in the scale of line_time.");
  v.option("end", l.end, "Last instant; may lie in the next GPS week or UTC day, and be the smaller number then.");
}

/// What is known of a simulated survey.
struct TruthFiles {
  std::optional<std::filesystem::path> trajectory, returns, dtm, calibration;
};

template <class V>
void describe(TruthFiles& t, V& v) {
  v.option("trajectory", t.trajectory, "SBET of the true trajectory.");
  v.option("returns", t.returns, "NumPy file of true returns, row by row as the laser records.");
  v.option("dtm", t.dtm, "GeoTIFF of the true terrain.");
  v.option("calibration", t.calibration, "True calibration.");
}

struct Survey {
  std::string name = "survey";
  std::string crs;
  std::optional<core::Metres> height_unit;
  SurveyArea area;
  core::Scanner scanner;
  core::Calibration calibration;
  core::SensorSigma sigma;
  std::optional<std::filesystem::path> calibration_file;
  std::vector<LaserFile> laser;
  std::vector<TrajectoryFile> trajectory;
  std::vector<ImuFile> imu;
  core::ImuSpec imu_spec;
  std::vector<GnssFile> gnss;
  Antenna antenna;
  Rinex rinex;
  std::vector<ClockLog> clock;
  std::vector<EventFile> events;
  std::vector<SurveyCamera> cameras;
  std::vector<ImageListFile> images;
  std::vector<ImageFile> image_points;
  std::vector<PhotoFiles> photos;
  std::vector<ControlFile> control;
  std::vector<BreaklineFile> breaklines;
  std::optional<std::filesystem::path> hangar;
  std::vector<PointFile> points;
  TimeTags line_time;
  std::vector<FlightLine> lines;
  TruthFiles truth;
  std::filesystem::path folder;  ///< of survey.toml; files are relative to it
};

template <class V>
void describe(Survey& s, V& v) {
  v.option("name", s.name, "Name of the survey.");
  v.option("crs", s.crs,
           "CRS of the products: \"EPSG:32632\", \"EPSG:25832+7837\", WKT or PROJ text; of clouds the first file's where left out.");
  v.option("height_unit", s.height_unit, core::above(0.0),
           "One unit of heights where the CRS has no vertical part, for example \"1 ft\"; without it the metre, and for point clouds the "
           "unit of the horizontal axes.");
  v.table("area", s.area,
          "Area of the survey: points outside it are left out and counted; without it that of the trajectory and 40 km around, or of the "
          "clouds without points that lie alone far away (docs/records.md).");
  v.table("scanner", s.scanner, "Scanner model.");
  v.table("calibration", s.calibration, "Calibration and mounting.");
  v.table("sigma", s.sigma, "How well calibration and records are known.");
  v.option("calibration_file", s.calibration_file,
           "Replaces values of [calibration] and [sigma], not stated record noise; .csd: boresight only.");
  v.tables("laser", s.laser, "Raw laser records.");
  v.tables("trajectory", s.trajectory, "Trajectory.");
  v.tables("imu", s.imu, "IMU records.");
  v.table("imu_spec", s.imu_spec, "What the IMU's data sheet says of its errors.");
  v.tables("gnss", s.gnss, "GNSS positions of the antenna.");
  v.table("antenna", s.antenna, "The GNSS antenna's place and time.");
  v.table("rinex", s.rinex, "Raw GNSS observations of rover and base stations.");
  v.tables("clock", s.clock, "Logs of the computer's clock.");
  v.tables("event", s.events, "Events to be placed on the time scale and the trajectory.");
  v.tables("camera", s.cameras, "Cameras whose exposures are events.");
  v.tables("image", s.images, "Tables of images: their names, and which event each one is.");
  v.tables("image_points", s.image_points, "Points measured on images.");
  v.tables("photos", s.photos, "Photographs whose orientation is known, or comes from the run: for colours and orthophotos.");
  v.tables("control", s.control, "Surveyed points and targets.");
  v.tables("breaklines", s.breaklines, "Breaklines, boundaries and water lines of the terrain.");
  v.option("hangar", s.hangar, "Measurements in a hangar for the lever arms (docs/lever-arm.md); may be the survey's only entry.");
  v.tables("points", s.points, "Point clouds in map coordinates, in place of raw records.");
  v.table("line_time", s.line_time, "Time scale of the lines' start and end.");
  v.tables("line", s.lines, "Flight lines.");
  v.table("truth", s.truth, "Truth of a simulated survey.");
}

/// The scanner model of a file's records: its own, else the survey's.
inline core::ScannerModel model_of(const Survey& survey, const LaserFile& file) { return file.model.value_or(survey.scanner.model); }

/// The format a file is read in: the one stated, or by the name's ending; `automatic` where the ending says nothing.
LaserFormat format_of(const LaserFile& file);
TrajectoryFormat format_of(const TrajectoryFile& file);
RecordFormat format_of(const ImuFile& file);
GnssFormat format_of(const GnssFile& file);

/// The trajectory files of a survey: those stated, or the CSD laser files where none is (their pulses carry their own poses).
std::vector<TrajectoryFile> trajectory_files(const Survey& survey);

/// A flight line in GPS time.
struct LineWindow {
  int id = 0;
  core::GpsTime start = 0, end = 0;
};
/// Longest line that may cross the end of a GPS week or UTC day, s.
constexpr double longest_crossing = 6 * 3600.0;
/// Length of a line, s; not above 0 where it does not end after it starts.
double seconds_of(const Survey& survey, const FlightLine& line);
/// The survey's lines in GPS time, by start. Throws Error where their time scale is not stated.
std::vector<LineWindow> line_windows(const Survey& survey);

/// The path of a file named in the survey.
std::filesystem::path resolve(const Survey& survey, const std::filesystem::path& file);

/// Metres of one unit of the heights that control and breaklines in a CRS have: what the CRS states, else the survey's height_unit, else
/// the unit of the horizontal axes in a survey of point clouds, whose heights are in it too; else the metre.
double metres_per_height(const Survey& survey, const core::Crs& crs);

}  // namespace swath::io

namespace swath::core {
template <>
struct Choices<io::LaserFormat> {
  static constexpr std::array<std::string_view, 5> names{"automatic", "text", "npy", "las", "csd"};
};
template <>
struct Choices<io::VelocityAxes> {
  static constexpr std::array<std::string_view, 4> names{"automatic", "ned", "nwu", "ignore"};
};
template <>
struct Choices<io::TrajectoryFormat> {
  static constexpr std::array<std::string_view, 4> names{"automatic", "sbet", "text", "csd"};
};
}  // namespace swath::core
