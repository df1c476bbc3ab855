// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/proposal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "core/printable.h"
#include "io/survey/column_roles.h"
#include "io/survey/survey_draft.h"
#include "io/survey/tree_kind.h"
#include "io/text/toml_text.h"

namespace swath::io {
namespace {

namespace fs = std::filesystem;
using core::Value;

std::string text_of(const Value& facts, std::string_view key) {
  const Value* found = facts.find(key);
  return found && found->is_text() ? found->as_text() : std::string();
}

/// Lowest and highest of a list of two numbers.
std::optional<std::pair<double, double>> interval_of(const Value& facts, std::string_view key) {
  const Value* found = facts.find(key);
  if (!found || !found->is_array() || found->items().size() != 2) return {};
  const Value &low = found->items()[0], &high = found->items()[1];
  if (!low.is_number() || !high.is_number()) return {};
  return std::pair(low.as_number(), high.as_number());
}

/// Points in a scanner's own frame: metres about the scanner, to both sides of it, without a CRS.
bool is_scanner_frame(const Value& facts) {
  constexpr double longest = 10000.0;  // m, no airborne laser ranges farther
  const auto x = interval_of(facts, "x"), y = interval_of(facts, "y"), z = interval_of(facts, "z");
  if (!x || !y || !z || !text_of(facts, "crs").empty()) return false;
  const auto near = [](const auto& v) { return std::abs(v.first) < longest && std::abs(v.second) < longest; };
  return near(*x) && near(*y) && near(*z) && y->first < 0.0 && y->second > 0.0;
}

using Files = std::vector<const FoundFile*>;

/// The files by the part of the survey that they make.
struct Sorted {
  Files points, scanner, csd, sbet, smrmsg, pos, nmea, observations, navigation, calibration, hangar, marks;
  std::vector<std::pair<const FoundFile*, ColumnRoles>> tables;
  std::vector<std::string> left;
  std::string zone;  ///< UTM zone of the first position found

  /// Measurements in a hangar and no record of a flight.
  bool only_hangar() const {
    return !hangar.empty() && points.empty() && sbet.empty() && pos.empty() && nmea.empty() && observations.empty() && tables.empty() &&
           marks.empty() && !has_laser();
  }
  const char* config() const { return only_hangar() ? "lever_arm" : "survey"; }
  bool has_laser() const { return !scanner.empty() || !csd.empty() || has(TableKind::laser); }
  bool has(TableKind kind) const {
    return std::any_of(tables.begin(), tables.end(), [&](const auto& t) { return t.second.kind == kind; });
  }
};

using Span = std::optional<std::pair<double, double>>;

void note_zone(const Span& latitude, const Span& longitude, Sorted& out) {
  if (!out.zone.empty() || !latitude || !longitude) return;
  constexpr double widest = 6.0;  // deg: wider where rows without a fix hold zeros
  if (longitude->second - longitude->first > widest || latitude->second - latitude->first > widest) return;
  if (!(std::abs(latitude->first) < 84.0) || !(std::abs(longitude->first) < 180.0)) return;
  const int zone = static_cast<int>(std::floor((longitude->first + 180.0) / 6.0)) + 1;
  out.zone = "EPSG:" + std::to_string((latitude->first < 0.0 ? 32700 : 32600) + zone);
}

/// The span of a table's column that has the role.
Span span_of(const Value& facts, const ColumnRoles& roles, std::string_view role) {
  for (const auto& [key, name] : roles.columns)
    if (key == role)
      for (const Value& column : facts.find("columns")->items())
        if (text_of(column, "name") == name) return interval_of(column, "span");
  return {};
}

ColumnRoles roles_in(const Value& facts) {
  std::vector<std::string> names, units;
  if (const Value* columns = facts.find("columns"))
    for (const Value& one : columns->items()) names.push_back(text_of(one, "name")), units.push_back(text_of(one, "unit"));
  return roles_of(names, units);
}

void sort_file(const FoundFile& f, Sorted& out) {
  const std::string format = text_of(f.facts, "format"), kind = text_of(f.facts, "kind");
  const auto left = [&](const std::string& why) { out.left.push_back(f.name.generic_string() + ": " + why); };
  if (f.facts.is_null()) return left("cannot be read: " + f.fault);
  for (const char* carrier : {"", "carrier_"})
    note_zone(interval_of(f.facts, std::string(carrier) + "latitude_deg"), interval_of(f.facts, std::string(carrier) + "longitude_deg"),
              out);
  const std::map<std::string, Files*> by_format{{"Optech CSD", &out.csd},      {"SBET", &out.sbet}, {"smrmsg", &out.smrmsg},
                                                {"RTKLIB solution", &out.pos}, {"NMEA", &out.nmea}, {"calibration", &out.calibration},
                                                {"hangar survey", &out.hangar}};
  if (format == "RTKLIB solution" && f.name.stem().string().ends_with("_events"))
    return left("positions at event marks, which are no record of a flight");
  if (const auto at = by_format.find(format); at != by_format.end()) return at->second->push_back(&f);
  if (format == "LAS" || format == "LAZ") return (is_scanner_frame(f.facts) ? out.scanner : out.points).push_back(&f);
  if (format == "RINEX") return (kind == "observations" ? out.observations : out.navigation).push_back(&f);
  if (format == "SP3 orbits") return out.navigation.push_back(&f);
  if (format == "NumPy array" || format == "delimited text") {
    ColumnRoles roles = roles_in(f.facts);
    if (roles.kind == TableKind::none) return left(format + " whose columns do not say what they are: see `swath info`");
    if (roles.angle_unit == "deg") note_zone(span_of(f.facts, roles, "latitude"), span_of(f.facts, roles, "longitude"), out);
    return out.tables.emplace_back(&f, std::move(roles)), void();
  }
  if (const TreeKind tree = kind_of_format(format); tree != TreeKind::other)
    return left(std::string(name_of(tree)) + ", not a record: " + std::string(use_of(tree)));
  if (format == "UBX (u-blox)" || format == "Timestamp.MRK (DJI)" || format == "MARKTIME (NovAtel)") {
    const Value* events = f.facts.find("events");
    if (events && events->is_int() && events->as_int() > 0) return out.marks.push_back(&f);
    return left(format + " without event marks: RTKLIB's convbin makes RINEX of raw observations");
  }
  if (format == "loopstats") return left("a log of clocks, which belongs to [[clock]] (docs/time.md)");
  if (format == "RTKLIB time tags") return left("times at which RTKLIB logged another file; `swath info` shows when the log began");
  if (format.find("capture") != std::string::npos) return left("packets of a sensor: export points or ranges by the maker's software");
  left(format + ", which has no place that can be known: a terrain model, lines or points may belong to [[breaklines]] or [[control]]");
}

bool ends_in(const FoundFile& f, std::initializer_list<const char*> endings) {
  const std::string ending = f.name.extension().string();
  return std::any_of(endings.begin(), endings.end(), [&](const char* one) { return ending == one; });
}

/// A record of the list with its format, where the name's ending does not say it.
void add_record(SurveyDraft& d, const std::string& list, const FoundFile& f, const char* format,
                std::initializer_list<const char*> endings) {
  d.list(list, f.name);
  if (!ends_in(f, endings)) d.known("format", format);
}

void open_week(SurveyDraft& d, const std::string& why) { d.open("time = { scale = \"gps_week\", week = 2317 }", why); }

/// What the names of the columns leave open.
std::string doubts_of(const ColumnRoles& r) {
  std::string out;
  const auto add = [&](const std::string& why) { out += (out.empty() ? "" : "; ") + why; };
  for (const auto& [key, name] : r.columns)
    if (key == "quality")
      add("quality = " + toml_scalar(name) + " only where its numbers are RTKLIB's (1 fixed, 2 float, 4 differential, 5 single)");
  if (!r.altitude.empty()) add(r.altitude + " must be above the ellipsoid: the logs of autopilots and GPX count from sea level");
  for (const std::string& name : r.foreign_units) add(name + " has a unit that is not read: convert it to m, s or the angle_unit");
  return out;
}

/// Times, units and columns of a table of records.
void add_table(SurveyDraft& d, const FoundFile& f, const ColumnRoles& r) {
  static constexpr std::array names{"", "laser", "imu", "gnss", "trajectory", "event"};
  d.list(names[static_cast<size_t>(r.kind)], f.name);
  if (r.kind != TableKind::event && !ends_in(f, {".csv", ".txt", ".npy"})) d.known("format", "text");
  const bool has_weeks = std::any_of(r.columns.begin(), r.columns.end(), [](const auto& c) { return c.first == "week"; });
  const std::string unit = r.time_unit.empty() ? "" : ", unit = \"" + r.time_unit + "\"";
  if (has_weeks || r.time_scale == "unix")
    d.line("time = { scale = \"" + std::string(has_weeks ? "gps_week" : "unix") + "\"" + unit + " }");
  else
    d.open("time = { scale = \"gps_week\", week = 2317" + unit + " }",
           r.time_scale == "gps_week" ? "times are seconds of the GPS week, and the file does not say of which"
                                      : "the file does not state its time scale: gps, gps_adjusted, gps_week, unix, utc_day or device");
  const auto unit_of = [&](const char* key, const std::string& found, const char* example, const char* choices) {
    if (!found.empty()) return d.known(key, found);
    d.open(std::string(key) + " = \"" + example + "\"", std::string("the names of the columns do not state it: ") + choices);
  };
  const auto has = [&](std::string_view key) {
    return std::any_of(r.columns.begin(), r.columns.end(), [&](const auto& c) { return c.first == key; });
  };
  if (r.kind == TableKind::imu) unit_of("kind", r.imu_kind, "increments", "increments or rates");
  if (r.mixed_angles)
    d.open("angle_unit = \"deg\"", "some columns are in deg and others in rad, and one unit is read: convert the file");
  else if (r.kind == TableKind::imu || r.kind == TableKind::trajectory || has("scan_angle") || has("latitude"))
    unit_of("angle_unit", r.angle_unit, "deg", "deg, rad or gon");
  if (r.kind == TableKind::imu) unit_of("acceleration_unit", r.acceleration_unit, "m/s2", "m/s2, g or mg");
  if (r.kind == TableKind::imu) d.open("axes = [\"x\", \"y\", \"z\"]", "which axes of the sensor point forward, right and down");
  std::string columns;
  if (r.is_on_map) d.open("crs = \"EPSG:25832\"", "northings and eastings are of a CRS that the file does not name");
  for (const auto& [key, name] : r.columns)
    if (key != "quality") columns += (columns.empty() ? "" : ", ") + key + " = " + toml_scalar(name);
  if (const std::string why = doubts_of(r); !why.empty()) d.doubt("columns", why);
  std::string open;
  if (r.has_open_axes)
    open = "X and Y do not say which is the northing (key latitude): mostly Y, but X in geodetic notation; geocentric ones are not read";
  if (r.has_rival_headings)
    open += std::string(open.empty() ? "" : "; ") + "of yaw and azimuth one is the heading of the body, from true north: name it";
  if (!open.empty()) return d.open("columns = { " + columns + " }", open);
  d.line("columns = { " + columns + " }  # by their names: check them");
}

/// Nothing of a table of image points says what its coordinates are.
void add_image_points(SurveyDraft& d, const FoundFile& f, const ColumnRoles& r) {
  d.list("image_points", f.name);
  for (const auto& [key, name] : r.columns)
    if (name + "_column" != key) d.known(key, name);
  d.open("unit = \"pixel\"", "the file does not state the unit of its coordinates: pixel, mm or um");
  d.open("y = \"down\"", "nor whether y points up or down");
  d.open("origin = \"corner\"", "nor where they count from: middle of the sensor, corner or pixel_centre of the first pixel");
  d.open("sigma_pixels = 0.5", "no file holds how well the points are measured");
}

void add_camera(SurveyDraft& d) {
  d.list("camera");
  d.open("f = \"50 mm\"", "no file holds the camera: principal distance, and x0, y0, k1 ... where they are known (docs/block.md)");
  d.open("columns = 7216", "pixels across");
  d.open("rows = 5412", "pixels down");
  d.open("pixel = \"6.8 um\"", "side of a pixel");
  d.open("mount = \"90 deg\"", "angle from the direction of flight to the image's x axis");
  d.open("lever_arm = [\"0 m\", \"0 m\", \"0 m\"]", "from the IMU's centre to the perspective centre, forward, right, down");
}

void add_head(SurveyDraft& d, const Sorted& s, const std::string& name) {
  d.note(
      "Proposed by swath init from the files of this folder. What # ? says is not known from the files: complete the line below it "
      "and");
  d.note("remove its #, or check the line where it has none. Then: swath check " + std::string(s.config()) + " --survey survey.toml");
  d.known("name", name);
  if (!s.hangar.empty()) {
    d.note("what was measured in a hangar: swath run lever_arm --survey survey.toml computes the lever arms (docs/lever-arm.md)");
    d.known("hangar", s.hangar.front()->name.generic_string()), d.count_file();
  }
  const std::string crs = "crs = \"" + (s.zone.empty() ? std::string("EPSG:25832") : s.zone) + "\"";
  if (s.has_laser()) {
    d.open(crs, "the CRS of the products is a choice" + std::string(s.zone.empty() ? "" : "; the files lie in this UTM zone"));
  } else if (!s.points.empty()) {
    const bool all_state = std::none_of(s.points.begin(), s.points.end(), [](auto* f) { return text_of(f->facts, "crs").empty(); });
    if (all_state) d.note("without crs the products are in the CRS of the first cloud: " + text_of(s.points.front()->facts, "crs"));
  }
  if (!s.calibration.empty())
    d.known("calibration_file", s.calibration.front()->name.generic_string()), d.count_file();
  else if (!s.csd.empty())
    d.line("calibration_file = " + toml_scalar(s.csd.front()->name.generic_string()) + "  # boresight of its header");
}

/// Times of LAS points whose scale or week has to be stated: by the header, where the times do not contradict it.
void open_scale(SurveyDraft& d, const Value& time) {
  constexpr double longest = 2.0 * 604800.0;
  const Span span = interval_of(time, "span");
  const bool says_week = text_of(time, "scale").starts_with("seconds");
  const bool may_be_week = !span || (span->first >= 0.0 && span->second < longest);
  if (says_week && may_be_week)
    open_week(d, "times are seconds of the GPS week, and the file does not say of which");
  else if (says_week)
    d.open("time = { scale = \"gps_adjusted\" }", "the header says seconds of the GPS week, the times are none");
  else if (span && span->second > 0.0 && may_be_week)
    open_week(d, "the header says adjusted standard GPS time, the times look like seconds of the week");
}

void add_laser(SurveyDraft& d, const Sorted& s) {
  const auto tables = std::count_if(s.tables.begin(), s.tables.end(), [](const auto& t) { return t.second.kind == TableKind::laser; });
  if (!s.scanner.empty() + !s.csd.empty() + (tables > 0) > 1)
    d.note("\n# ? Laser records in several formats may be the same records: keep one [[laser]] for each.");
  for (const FoundFile* f : s.scanner) {
    d.list("laser", f->name);
    d.note("? taken for the scanner's own frame: for a map in local coordinates write points in place of laser");
    if (const Value* time = f->facts.find("time")) open_scale(d, *time);
  }
  for (const FoundFile* f : s.csd) add_record(d, "laser", *f, "csd", {".csd"});
}

void add_trajectory(SurveyDraft& d, const Sorted& s) {
  for (size_t k = 0; k < s.sbet.size(); ++k) {
    add_record(d, "trajectory", *s.sbet[k], "sbet", {".out", ".sbet"});
    open_week(d, "an SBET holds seconds of the GPS week, and not of which");
    if (s.smrmsg.size() == s.sbet.size()) d.known("accuracy", s.smrmsg[k]->name.generic_string()), d.count_file();
  }
  if (s.smrmsg.size() != s.sbet.size())
    for (const FoundFile* f : s.smrmsg) d.note("? " + f->name.generic_string() + ": the SBET that these accuracies belong to is not known");
}

/// Solutions of one time, of which a survey takes one. UTC texts are in the order of time.
void note_rivals(SurveyDraft& d, const Files& files) {
  const auto meet = [](const Value& a, const Value& b) {
    const std::string from = text_of(a, "from"), again = text_of(b, "from");
    return !from.empty() && !again.empty() && from <= text_of(b, "to") && again <= text_of(a, "to");
  };
  for (size_t i = 0; i < files.size(); ++i)
    for (size_t j = i + 1; j < files.size(); ++j)
      if (meet(files[i]->facts, files[j]->facts))
        d.note("\n# ? " + files[i]->name.generic_string() + " and " + files[j]->name.generic_string() +
               " cover the same time: keep one [[gnss]] of them.");
}

void add_gnss(SurveyDraft& d, const Sorted& s) {
  Files solutions = s.pos;
  solutions.insert(solutions.end(), s.nmea.begin(), s.nmea.end());
  note_rivals(d, solutions);
  for (const FoundFile* f : s.pos) add_record(d, "gnss", *f, "pos", {".pos"});
  for (const FoundFile* f : s.nmea) {
    add_record(d, "gnss", *f, "nmea", {".nmea", ".log"});
    if (text_of(f->facts, "from").empty()) d.open("time = { date = \"2026-01-31\" }", "its sentences do not state the date");
  }
  if (s.observations.empty()) return;
  const auto names = [](const Files& files) {
    Value out = Value::array();
    for (const FoundFile* f : files) out.push(f->name.generic_string());
    return out;
  };
  d.table("rinex");
  for (size_t k = 0; k < s.observations.size() + s.navigation.size(); ++k) d.count_file();
  if (s.observations.size() == 1)
    d.known("rover", names(s.observations));
  else
    d.open(
        "rover = " + toml_scalar(names({s.observations.front()})),
        "which of these is the aircraft's: " + toml_scalar(names(s.observations)) + "; the others belong to [[rinex.base]] observations");
  if (!s.navigation.empty()) d.known("navigation", names(s.navigation));
}

/// What no file holds: scanner, mounting, lever arms.
void add_mounting(SurveyDraft& d, const Sorted& s) {
  const bool fixes = !s.pos.empty() || !s.nmea.empty() || !s.observations.empty() || s.has(TableKind::gnss);
  if (s.has(TableKind::imu)) {
    d.table("imu_spec");
    d.open("grade = \"tactical\"", "no file holds the IMU's data sheet: its grade, or its values");
  }
  if (s.has(TableKind::imu) && fixes) {
    d.table("antenna");
    d.open("lever_arm = [\"0 m\", \"0 m\", \"0 m\"]", "no file holds it: from the IMU's centre to the antenna, forward, right, down");
  }
  if (!s.has_laser()) return;
  d.table("scanner");
  if (s.csd.empty())
    d.open("model = \"mirror\"", "the records do not name it: mirror, polygon, profile, conical, palmer or beam (docs/survey.md)");
  else
    d.known("model", "mirror");
  if (!s.calibration.empty()) return;
  d.table("calibration");
  if (s.csd.empty())
    for (const char* angle : {"roll", "pitch", "heading"})
      d.open(std::string(angle) + " = \"0 deg\"", "no file holds the boresight angles");
  d.open("lever_arm_scanner = [\"0 m\", \"0 m\", \"0 m\"]", "no file holds it: from the IMU's centre to the scanner, forward, right, down");
}

}  // namespace

Proposal propose_survey(const std::vector<FoundFile>& files, const std::string& name) {
  Sorted s;
  for (const FoundFile& f : files) sort_file(f, s);
  for (size_t k = 1; k < s.hangar.size(); ++k) s.left.push_back(s.hangar[k]->name.generic_string() + ": a second hangar survey");
  SurveyDraft d;
  add_head(d, s, name);
  add_mounting(d, s);
  add_laser(d, s);
  add_trajectory(d, s);
  add_gnss(d, s);
  if (s.has(TableKind::image_points)) add_camera(d);
  for (const auto& [file, roles] : s.tables)
    roles.kind == TableKind::image_points ? add_image_points(d, *file, roles) : add_table(d, *file, roles);
  for (const FoundFile* f : s.marks) d.list("event", f->name);
  for (const FoundFile* f : s.points) {
    if (s.has_laser()) {
      s.left.push_back(f->name.generic_string() + ": a cloud in map coordinates, which a survey of raw records does not take");
      continue;
    }
    d.list("points", f->name);
    if (text_of(f->facts, "crs").empty()) d.open("crs = \"EPSG:25832\"", "the file states no CRS that is understood");
  }
  if (s.has_laser()) d.note("\n# Without [[line]] tables (id, start, end) the flight lines are those of the records; docs/survey.md.");
  if (!s.left.empty()) d.note("\n# Not part of this survey:");
  for (const std::string& one : s.left) d.note("  " + one);
  return {d.text(), d.files(), d.questions(), s.config()};
}

}  // namespace swath::io
