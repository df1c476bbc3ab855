// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/survey_checks.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/geo/crs.h"
#include "io/records/csd.h"
#include "io/records/event_marks.h"
#include "io/records/imu_axes.h"
#include "io/store/address.h"
#include "io/survey/line_checks.h"
#include "io/text/text_faults.h"

namespace swath::io {

core::Location place_in(const core::Value& tree, const std::string& key) {
  const core::Value* at = &tree;
  size_t i = 0;
  while (i < key.size()) {
    const size_t stop = std::min(key.find_first_of(".[", i), key.size());
    const core::Value* next = at->find(key.substr(i, stop - i));
    if (!next) break;
    at = next;
    i = stop;
    if (i < key.size() && key[i] == '[') {
      const size_t number = std::stoul(key.substr(i + 1));
      if (!at->is_array() || number > at->items().size()) break;
      at = &at->items()[number - 1];
      i = key.find(']', i) + 1;
    }
    if (i < key.size() && key[i] == '.') ++i;
  }
  return at->where;
}

namespace {

using core::Fault;
using core::Value;

/// The conditions between a survey's options and with the files on disk. A key that already has a fault gets no second one.
class Checks {
 public:
  Checks(const Survey& survey, const Value& tree, std::vector<Fault>& faults, RecordsIn records)
      : survey_(survey), tree_(tree), faults_(faults), records_(records) {}

  void all() {
    project();
    for (size_t i = 0; i < survey_.laser.size(); ++i) laser(survey_.laser[i], numbered("laser", i));
    for (size_t i = 0; i < survey_.trajectory.size(); ++i) trajectory(survey_.trajectory[i], numbered("trajectory", i));
    for (size_t i = 0; i < survey_.imu.size(); ++i) imu(survey_.imu[i], numbered("imu", i));
    for (size_t i = 0; i < survey_.gnss.size(); ++i) gnss(survey_.gnss[i], numbered("gnss", i));
    for (size_t i = 0; i < survey_.clock.size(); ++i) exists(survey_.clock[i].file, numbered("clock", i) + ".file");
    for (size_t i = 0; i < survey_.events.size(); ++i) event(survey_.events[i], numbered("event", i));
    for (size_t i = 0; i < survey_.control.size(); ++i) exists(survey_.control[i].file, numbered("control", i) + ".file");
    for (size_t i = 0; i < survey_.breaklines.size(); ++i) exists(survey_.breaklines[i].file, numbered("breaklines", i) + ".file");
    if (survey_.hangar) exists(*survey_.hangar, "hangar");
    for (size_t i = 0; i < survey_.points.size(); ++i)
      if (!is_address(survey_.points[i].file)) exists(survey_.points[i].file, numbered("points", i) + ".file");  // else when it is opened
    repeated();
    lever_arm(survey_.calibration.lever_arm_scanner, "calibration.lever_arm_scanner");
    lever_arm(survey_.antenna.lever_arm, "antenna.lever_arm");
    lines();
    const TruthFiles& t = survey_.truth;
    for (const auto& [name, file] :
         {std::pair{"trajectory", &t.trajectory}, {"returns", &t.returns}, {"dtm", &t.dtm}, {"calibration", &t.calibration}})
      if (*file) exists(**file, std::string("truth.") + name);
  }

 private:
  void fault(const std::string& key, std::string what, std::string hint = {}) {
    for (const Fault& f : faults_)
      if (f.key == key) return;
    faults_.push_back({place_in(tree_, key), key, std::move(what), std::move(hint)});
  }

  void exists(const std::filesystem::path& file, const std::string& key) {
    if (file.empty()) return fault(key, "no file is named");
    const auto path = resolve(survey_, file);
    if (is_address(path)) return fault(key, "only clouds and rasters are read from a store, not " + path.string(), "fetch the file");
    std::error_code ec;
    if (!std::filesystem::exists(path, ec))
      fault(key, "no such file: " + path.string(), "names are relative to the folder of the survey file");
    else if (std::filesystem::is_directory(path, ec))
      fault(key, path.string() + " is a folder, not a file");
  }

  void project() {
    // A survey may be of a trajectory or of events alone; with IMU, GNSS or raw observations the trajectory is computed.
    const bool computed = !survey_.imu.empty() || !survey_.gnss.empty() || !survey_.rinex.rover.empty();
    // One of a hangar has no records of a flight at all.
    const bool navigation = (computed || !survey_.trajectory.empty() || !survey_.events.empty() || survey_.hangar) && survey_.laser.empty();
    if (survey_.crs.empty()) {
      if (survey_.points.empty() && !navigation)
        fault("crs", "the CRS of the products is missing", "state it, for example crs = \"EPSG:32632\"");
    } else {
      try {
        core::Crs{survey_.crs};
      } catch (const core::Error& e) {
        fault("crs", e.what(), e.hint());
      }
    }
    if (survey_.calibration_file) exists(*survey_.calibration_file, "calibration_file");
    const bool raw = !survey_.laser.empty();
    if (raw && !survey_.points.empty()) fault("points", "a survey has either raw [[laser]] records or georeferenced [[points]], not both");
    const bool in_files = records_ == RecordsIn::files;
    if (in_files && !raw && survey_.points.empty() && !navigation)
      fault("laser", "no records: neither [[laser]] nor [[points]] is there, nor [[trajectory]], [[imu]], [[gnss]], [[event]] or hangar");
    const auto is_csd = [](const LaserFile& f) { return format_of(f) == LaserFormat::csd; };
    if (in_files && raw && survey_.trajectory.empty() && !computed && !std::all_of(survey_.laser.begin(), survey_.laser.end(), is_csd))
      fault("trajectory", "raw [[laser]] records need a [[trajectory]], or [[imu]] and [[gnss]] records to compute it from");
    const Value* antenna = tree_.find("antenna");
    const bool fixes = !survey_.gnss.empty() || !survey_.rinex.rover.empty();
    if (!survey_.imu.empty() && fixes && survey_.trajectory.empty() && !(antenna && antenna->find("lever_arm")))
      fault("antenna.lever_arm", "IMU and GNSS records go together through the antenna's lever arm, which is not stated",
            "state it as [antenna] lever_arm = [\"... m\", \"... m\", \"... m\"] from the IMU's centre: forward, right, down");
    const Value* calibration = tree_.find("calibration");
    const bool boresight = calibration && (calibration->find("roll") || calibration->find("pitch") || calibration->find("heading"));
    if (std::any_of(survey_.laser.begin(), survey_.laser.end(), is_csd) && !survey_.calibration_file && !boresight)
      fault("calibration", "the boresight of CSD records is not stated",
            "state calibration_file = the .csd file to use its header's values, or roll, pitch and heading in [calibration]");
  }

  /// `in_file`: the format states its own scale, which the survey may leave unstated.
  void time(const TimeTags& t, const std::string& key, bool week_column, bool in_file) {
    using core::TimeScale;
    if (t.scale == TimeScale::unstated && !in_file)
      fault(key + ".scale", "the time scale is not stated", "one of gps, gps_adjusted, gps_week, unix, utc_day, device");
    if (t.scale == TimeScale::gps_week && !t.week && !week_column)
      fault(key + ".week", "scale gps_week needs the GPS week of the first record");
    if (t.week && t.scale != TimeScale::gps_week && !in_file) fault(key + ".week", "a week has a meaning with scale gps_week only");
    if (week_column && t.week) fault(key + ".week", "the weeks come from a column; a stated week would have no effect");
    if (week_column && t.scale != TimeScale::gps_week && t.scale != TimeScale::unstated)
      fault(key + ".scale", "a column of weeks goes with scale gps_week only");
    if (t.scale == TimeScale::utc_day && t.date.empty()) fault(key + ".date", "scale utc_day needs the UTC date of the first record");
    if (!t.date.empty() && t.scale != TimeScale::utc_day) fault(key + ".date", "a date has a meaning with scale utc_day only");
    if (t.scale == TimeScale::device && t.origin.empty()) fault(key + ".origin", "scale device needs the instant of the device's zero");
    if (!t.origin.empty() && t.scale != TimeScale::device) fault(key + ".origin", "an origin has a meaning with scale device only");
    if (t.origin_at != 0 && t.scale != TimeScale::device) fault(key + ".origin_at", "has a meaning with scale device only");
    if (!t.origin.empty() && !core::gps_of_civil(t.origin))
      fault(key + ".origin", "'" + t.origin + "' is no instant", "write it as \"YYYY-MM-DDThh:mm:ss.sss GPS\" (or UTC)");
    if (t.scale == TimeScale::utc_day && !t.date.empty() && !core::unix_of_date(t.date))
      fault(key + ".date", "'" + t.date + "' is no date", "write it as YYYY-MM-DD");
  }

  void no_format(const std::filesystem::path& file, const std::string& key, const std::string& formats) {
    if (has_packed_ending(file))
      return fault(key + ".file", "'" + file.string() + "' is packed", "unpack it first, and name the file that it holds");
    fault(key + ".format", "the ending of '" + file.string() + "' belongs to none of the formats", "state one of " + formats);
  }

  void laser(const LaserFile& f, const std::string& key) {
    exists(f.file, key + ".file");
    const LaserFormat format = format_of(f);
    const LaserColumns& c = f.columns;
    const bool own_scale = format == LaserFormat::las || format == LaserFormat::csd;
    if (format == LaserFormat::automatic) return no_format(f.file, key, "text, npy, las, csd");
    time(f.time, key + ".time", !c.week.empty(), own_scale);
    const auto model = model_of(survey_, f);
    const auto scans_across = [](core::ScannerModel m) {
      return m == core::ScannerModel::mirror || m == core::ScannerModel::polygon || m == core::ScannerModel::profile;
    };
    if (f.model && *f.model != survey_.scanner.model && !(scans_across(*f.model) && scans_across(survey_.scanner.model)))
      fault(key + ".model", "a file may have another model than scanner.model only among mirror, polygon and profile",
            "give records of other scanners a survey of their own");
    if (format == LaserFormat::csd) csd_week(f, key);
    const bool xyz = format == LaserFormat::las || !c.x.empty() || !c.y.empty() || !c.z.empty();
    if (xyz && (model == core::ScannerModel::conical || model == core::ScannerModel::palmer))
      fault("scanner.model", "records with x, y, z are beams already", "use model \"beam\" (or \"mirror\")");
    if (!xyz && model == core::ScannerModel::beam)
      fault("scanner.model", "model \"beam\" needs records with x, y, z in the scanner frame (" + key + ")");
    if (xyz && f.angle_to_port) fault(key + ".angle_to_port", "has no effect on records with x, y, z");
    if (own_scale) {
      if (f.angle_unit != AngleUnit::unstated) fault(key + ".angle_unit", "has no effect: the format defines its angles");
      if (f.range_unit.value != 1.0 && format == LaserFormat::csd) fault(key + ".range_unit", "has no effect: CSD ranges are metres");
      if (tree_at(key + ".columns")) fault(key + ".columns", "has no effect: the format defines its fields");
      return;
    }
    if (format != LaserFormat::text && !f.delimiter.empty()) fault(key + ".delimiter", "has no effect: the file is no text");
    if (c.time.empty()) fault(key + ".columns.time", "the column of times is not named");
    if (f.line && !c.line.empty()) fault(key + ".line", "lines come from a column; a stated line would have no effect");
    if (xyz) {
      if (c.x.empty() || c.y.empty() || c.z.empty()) fault(key + ".columns", "x, y and z go together; one of them is not named");
      if (!c.range.empty() || !c.scan_angle.empty()) fault(key + ".columns", "either x, y, z or range and scan_angle, not both");
      if (f.angle_unit != AngleUnit::unstated) fault(key + ".angle_unit", "has no effect on records with x, y, z");
      return;
    }
    if (c.range.empty()) fault(key + ".columns.range", "the column of ranges is not named (nor x, y, z)");
    if (c.scan_angle.empty()) {
      if (model != core::ScannerModel::profile)
        fault(key + ".columns.scan_angle", "the column of scan angles is not named",
              "only model \"profile\" goes without: of the scanner, or of this file");
    } else if (f.angle_unit == AngleUnit::unstated) {
      fault(key + ".angle_unit", "the unit of the recorded angles is not stated", "one of deg, rad, gon");
    }
  }

  /// The week that a CSD file's header states against the survey's.
  void csd_week(const LaserFile& f, const std::string& key) {
    try {
      if (f.time.week) hold_csd_week(resolve(survey_, f.file), *f.time.week);
    } catch (const core::Error& e) {
      // A damaged file is left to its reader, which names the byte.
      if (e.code() == core::Exit::bad_usage) fault(key + ".time.week", e.what(), e.hint());
    }
  }

  void trajectory(const TrajectoryFile& f, const std::string& key) {
    exists(f.file, key + ".file");
    if (f.accuracy) exists(*f.accuracy, key + ".accuracy");
    const TrajectoryFormat format = format_of(f);
    const TrajectoryColumns& c = f.columns;
    if (format == TrajectoryFormat::automatic) return no_format(f.file, key, "sbet, text, csd");
    time(f.time, key + ".time", !c.week.empty(), format == TrajectoryFormat::csd);
    if (f.accuracy && format != TrajectoryFormat::sbet) fault(key + ".accuracy", "smrmsg files go with SBET files only");
    if (format != TrajectoryFormat::text) {
      if (tree_at(key + ".columns")) fault(key + ".columns", "has no effect: the format defines its fields");
      if (f.angle_unit != AngleUnit::unstated) fault(key + ".angle_unit", "has no effect: the format's angles are radians");
      if (!f.crs.empty()) fault(key + ".crs", "has no effect: the format's positions are geodetic WGS84");
      return;
    }
    for (const auto& [name, column] : {std::pair{"time", &c.time},
                                       {"latitude", &c.latitude},
                                       {"longitude", &c.longitude},
                                       {"height", &c.height},
                                       {"roll", &c.roll},
                                       {"pitch", &c.pitch},
                                       {"heading", &c.heading}})
      if (column->empty()) fault(key + ".columns." + name, "the column is not named");
    const int velocities = !c.v_north.empty() + !c.v_east.empty() + !c.v_down.empty();
    if (velocities == 1 || velocities == 2) fault(key + ".columns", "v_north, v_east and v_down go together; one of them is not named");
    if (f.angle_unit == AngleUnit::unstated) fault(key + ".angle_unit", "the unit of angles is not stated", "one of deg, rad, gon");
  }

  void imu(const ImuFile& f, const std::string& key) {
    exists(f.file, key + ".file");
    const RecordFormat format = format_of(f);
    const ImuColumns& c = f.columns;
    if (format == RecordFormat::automatic) return no_format(f.file, key, "text, npy");
    time(f.time, key + ".time", !c.week.empty(), false);
    if (format != RecordFormat::text && !f.delimiter.empty()) fault(key + ".delimiter", "has no effect: the file is no text");
    if (f.kind == ImuKind::unstated)
      fault(key + ".kind", "it is not stated whether the records are increments or rates", "one of increments, rates");
    if (f.angle_unit == AngleUnit::unstated) fault(key + ".angle_unit", "the unit of angles is not stated", "one of deg, rad, gon");
    if (f.acceleration_unit == AccelerationUnit::unstated)
      fault(key + ".acceleration_unit", "the unit of specific force is not stated", "one of m/s2, g, mg");
    if (f.sample == ImuSample::instant && f.kind == ImuKind::increments)
      fault(key + ".sample", "has no effect: increments cover their interval");
    if (f.sample == ImuSample::instant && f.kind == ImuKind::rates && f.stamp != ImuStamp::end)
      fault(key + ".stamp", "has no effect: samples of an instant have no interval");
    for (const auto& [name, column] : {std::pair{"time", &c.time},
                                       {"gyro_x", &c.gyro_x},
                                       {"gyro_y", &c.gyro_y},
                                       {"gyro_z", &c.gyro_z},
                                       {"accelerometer_x", &c.accelerometer_x},
                                       {"accelerometer_y", &c.accelerometer_y},
                                       {"accelerometer_z", &c.accelerometer_z}})
      if (column->empty()) fault(key + ".columns." + name, "the column is not named");
    try {
      body_R_record(f);
    } catch (const core::Error& e) {
      fault(key + ".axes", e.what(), e.hint());
    }
  }

  void gnss(const GnssFile& f, const std::string& key) {
    exists(f.file, key + ".file");
    const GnssFormat format = format_of(f);
    const GnssColumns& c = f.columns;
    if (format == GnssFormat::automatic) return no_format(f.file, key, "text, pos, nmea");
    if (f.geoid_height) fault(key + ".geoid_height", "heights above the geoid are not read", "write the solution with ellipsoidal heights");
    if (f.base && format != GnssFormat::pos) fault(key + ".base", "has no effect: only RTKLIB's baselines have a base");
    if (format != GnssFormat::text) return own_fields(f, key, format == GnssFormat::nmea);
    time(f.time, key + ".time", !c.week.empty(), false);
    if (c.time.empty()) fault(key + ".columns.time", "the column of times is not named");
    const auto together = [&](const char* names, std::initializer_list<const std::string*> columns) {
      const auto named = std::count_if(columns.begin(), columns.end(), [](const std::string* s) { return !s->empty(); });
      if (named != 0 && named != static_cast<std::ptrdiff_t>(columns.size()))
        fault(key + ".columns", std::string(names) + " go together; one of them is not named");
      return named != 0;
    };
    const bool geodetic = together("latitude, longitude and height", {&c.latitude, &c.longitude, &c.height});
    const bool ecef = together("x, y and z", {&c.x, &c.y, &c.z});
    if (geodetic == ecef)
      fault(key + ".columns", geodetic ? "either latitude, longitude, height or x, y, z, not both" : "no columns of positions are named");
    if (geodetic && f.angle_unit == AngleUnit::unstated)
      fault(key + ".angle_unit", "the unit of angles is not stated", "one of deg, rad, gon");
    const bool full = together("the six cov_ columns", {&c.cov_xx, &c.cov_xy, &c.cov_xz, &c.cov_yy, &c.cov_yz, &c.cov_zz});
    const bool sigmas = together("sigma_north, sigma_east and sigma_up", {&c.sigma_north, &c.sigma_east, &c.sigma_up});
    if (full && sigmas) fault(key + ".columns", "either the cov_ columns or the sigma_ columns, not both");
    const bool velocity = together("v_north, v_east and v_up", {&c.v_north, &c.v_east, &c.v_up});
    const bool sigma_v = together("sigma_v_north, sigma_v_east and sigma_v_up", {&c.sigma_v_north, &c.sigma_v_east, &c.sigma_v_up});
    if (sigma_v && !velocity) fault(key + ".columns", "sigmas of the velocity without v_north, v_east and v_up");
  }

  void event(const EventFile& f, const std::string& key) {
    exists(f.file, key + ".file");
    const std::filesystem::path path = resolve(survey_, f.file);
    std::error_code absent;
    const EventFormat format = std::filesystem::is_regular_file(path, absent) ? format_of(f, path) : f.format;
    if (format != EventFormat::ubx && f.edge != EventEdge::rising) fault(key + ".edge", "has no effect: only UBX files know both edges");
    if (format != EventFormat::ubx && format != EventFormat::novatel && f.input != 0)
      fault(key + ".input", "has no effect: the format has one input");
    if (format == EventFormat::automatic || format == EventFormat::text) {
      time(f.time, key + ".time", false, false);
      if (f.columns.time.empty()) fault(key + ".columns.time", "the column of times is not named");
      return;
    }
    const TimeTags& t = f.time;
    if (t.scale != core::TimeScale::unstated || t.week || !t.date.empty() || t.unit.value != 1 || !t.origin.empty() || t.origin_at != 0)
      fault(key + ".time", "has no effect: the format states its own time scale", "only `offset` acts on these files");
    if (tree_at(key + ".columns")) fault(key + ".columns", "has no effect: the format defines its fields");
    if (!f.delimiter.empty()) fault(key + ".delimiter", "has no effect: the format defines it");
    if (f.computer_clock) fault(key + ".computer_clock", "contradicts the format: its times are those of GNSS");
  }

  /// Faults of options that the format leaves nothing to do for.
  void own_fields(const GnssFile& f, const std::string& key, bool nmea) {
    if (tree_at(key + ".columns")) fault(key + ".columns", "has no effect: the format defines its fields");
    if (!f.delimiter.empty()) fault(key + ".delimiter", "has no effect: the format defines it");
    if (f.angle_unit != AngleUnit::deg) fault(key + ".angle_unit", "has no effect: the format's angles are degrees");
    const TimeTags& t = f.time;
    if (t.scale != core::TimeScale::unstated) fault(key + ".time.scale", "has no effect: the format states its own");
    if (t.week) fault(key + ".time.week", "has no effect: the format states its own");
    if (t.unit.value != 1) fault(key + ".time.unit", "has no effect: the format states its own");
    if (!t.origin.empty() || t.origin_at != 0) fault(key + ".time.origin", "has no effect: the format states its own");
    if (!t.date.empty() && !nmea) fault(key + ".time.date", "has no effect: the format states its own");
    if (!t.date.empty() && nmea && !core::unix_of_date(t.date))
      fault(key + ".time.date", "'" + t.date + "' is no date", "write it as YYYY-MM-DD");
  }

  void lines() {
    if (survey_.lines.empty()) return;
    time(survey_.line_time, "line_time", false, false);
    if (survey_.line_time.unit.value != 1) fault("line_time.unit", "has no effect: start and end of a line state their own units");
    if (survey_.line_time.origin_at != 0) fault("line_time.origin_at", "has no effect: state the origin at zero");
    for (const LineFault& f : line_faults(survey_)) fault(numbered("line", f.line) + "." + f.key, f.what, f.hint);
  }

  /// Records that would be read twice. One text file may serve two tables with other columns, or other lines.
  void repeated() {
    const auto same_columns = [](const LaserColumns& a, const LaserColumns& b) {
      return a.range == b.range && a.scan_angle == b.scan_angle && a.x == b.x;
    };
    for (size_t i = 0; i < survey_.laser.size(); ++i)
      for (size_t j = 0; j < i; ++j) {
        const LaserFile &a = survey_.laser[j], &b = survey_.laser[i];
        if (same_file(a.file, b.file) && a.line == b.line && a.model == b.model && same_columns(a.columns, b.columns))
          fault(numbered("laser", i) + ".file", "the file is that of " + numbered("laser", j) + ": its records would be read twice");
      }
    for (size_t i = 0; i < survey_.points.size(); ++i)
      for (size_t j = 0; j < i; ++j)
        if (same_file(survey_.points[j].file, survey_.points[i].file))
          fault(numbered("points", i) + ".file", "the file is that of " + numbered("points", j) + ": its points would be read twice");
  }

  bool same_file(const std::filesystem::path& a, const std::filesystem::path& b) const {
    return !a.empty() && resolve(survey_, a).lexically_normal() == resolve(survey_, b).lexically_normal();
  }

  void lever_arm(const std::array<core::Metres, 3>& arm, const std::string& key) {
    constexpr double longest = 100.0;  // m: the longest aircraft has 84
    for (const core::Metres part : arm)
      if (std::abs(part.value) > longest)
        return fault(key, core::format_number(part.value) + " m is farther than any aircraft is long", "millimetres stated as metres?");
  }

  bool tree_at(const std::string& key) const {
    const core::Location there = place_in(tree_, key), parent = place_in(tree_, key.substr(0, key.rfind('.')));
    return there.line != parent.line || there.column != parent.column;
  }

  const Survey& survey_;
  const Value& tree_;
  std::vector<Fault>& faults_;
  RecordsIn records_;
};

}  // namespace

void check_survey(const Survey& survey, const Value& tree, std::vector<Fault>& faults, RecordsIn records) {
  Checks(survey, tree, faults, records).all();
}

}  // namespace swath::io
