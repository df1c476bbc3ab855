// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/column_roles.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <set>
#include <string_view>

#include "core/printable.h"

namespace swath::io {
namespace {

/// A key of [columns] and names in use for it, without their units, those that are clearer first.
struct Role {
  std::string_view key;
  std::vector<std::string_view> names;
};

struct Kind {
  TableKind kind;
  std::vector<Role> roles;
  std::vector<std::vector<std::string_view>> required;  ///< one of these sets of keys
};

const Role time_role{"time", {"gps_sow",     "gpssow",    "sow",          "tow",      "gps_tow", "seconds_of_week", "second_of_week",
                              "sec_of_week", "secofweek", "time_of_week", "gps_time", "gpstime", "gps_seconds",     "gpsseconds",
                              "gps_sec",     "gpssec",    "unix_time",    "time",     "t",       "timestamp",       "utc",
                              "seconds",     "sec"}};
const Role week_role{"week", {"week", "gps_week", "gpsweek", "gpsw", "wn"}};
const Role height_role{"height",
                       {"h_ell", "hell", "ellh", "ell_height", "ellipsoidal_height", "ellipsoid_height", "ellipsoidalheight",
                        "ellipsoidheight", "altitude_ellipsoid", "height", "h", "altitude", "alt", "elevation", "elev"}};

/// Coordinates of a trajectory on a map, northing and easting: the clearer first. The last mean both.
struct MapPair {
  std::string_view northing, easting;
};
constexpr std::array<MapPair, 4> map_pairs{{{"northing", "easting"}, {"north", "east"}, {"n", "e"}, {"y", "x"}}};

/// In the order of the search: what needs more columns comes first.
const std::vector<Kind>& kinds() {
  static const std::vector<Kind> list{
      {TableKind::imu,
       {time_role,
        week_role,
        {"gyro_x", {"gyro_x", "gyr_x", "gx", "wx", "omega_x", "angular_rate_x", "dtheta_x", "dangle_x"}},
        {"gyro_y", {"gyro_y", "gyr_y", "gy", "wy", "omega_y", "angular_rate_y", "dtheta_y", "dangle_y"}},
        {"gyro_z", {"gyro_z", "gyr_z", "gz", "wz", "omega_z", "angular_rate_z", "dtheta_z", "dangle_z"}},
        {"accelerometer_x", {"accelerometer_x", "acc_x", "accel_x", "ax", "fx", "dv_x", "dvel_x"}},
        {"accelerometer_y", {"accelerometer_y", "acc_y", "accel_y", "ay", "fy", "dv_y", "dvel_y"}},
        {"accelerometer_z", {"accelerometer_z", "acc_z", "accel_z", "az", "fz", "dv_z", "dvel_z"}}},
       {{"time", "gyro_x", "gyro_y", "gyro_z", "accelerometer_x", "accelerometer_y", "accelerometer_z"}}},
      {TableKind::trajectory,
       {time_role,
        week_role,
        {"latitude", {"latitude", "lat"}},
        {"longitude", {"longitude", "lon", "lng", "long"}},
        height_role,
        {"roll", {"roll"}},
        {"pitch", {"pitch"}},
        {"heading", {"heading", "true_heading", "hdg", "yaw", "azimuth"}},
        {"v_north", {"v_north"}},
        {"v_east", {"v_east"}},
        {"v_down", {"v_down"}},
        {"sigma_north", {"sigma_north", "sdnorth", "sd_north", "north_sd"}},
        {"sigma_east", {"sigma_east", "sdeast", "sd_east", "east_sd"}},
        {"sigma_down", {"sigma_down", "sdheight", "sd_down", "sd_height", "height_sd"}},
        {"sigma_roll", {"sigma_roll", "rollsd", "sd_roll", "roll_sd", "std_roll", "roll_std"}},
        {"sigma_pitch", {"sigma_pitch", "pitchsd", "sd_pitch", "pitch_sd", "std_pitch", "pitch_std"}},
        {"sigma_heading", {"sigma_heading", "hdngsd", "headingsd", "sd_heading", "heading_sd", "std_heading", "heading_std"}}},
       {{"time", "latitude", "longitude", "height", "roll", "pitch", "heading"}}},
      {TableKind::laser,
       {time_role,
        week_role,
        {"line", {"line", "strip", "flight_line", "line_id"}},
        {"scan_angle", {"scan_angle", "angle", "mirror_angle", "encoder_angle"}},
        {"range", {"range", "distance", "slant_range"}},
        {"intensity", {"intensity", "amplitude"}},
        {"return_number", {"return_number", "return", "echo", "echo_number"}},
        {"return_count", {"return_count", "number_of_returns", "returns", "echoes"}}},
       {{"time", "range"}}},
      {TableKind::gnss,
       {time_role,
        week_role,
        {"latitude", {"latitude", "lat"}},
        {"longitude", {"longitude", "lon", "lng", "long"}},
        height_role,
        {"x", {"ecef_x"}},
        {"y", {"ecef_y"}},
        {"z", {"ecef_z"}},
        {"cov_xx", {"cov_xx"}},
        {"cov_xy", {"cov_xy"}},
        {"cov_xz", {"cov_xz"}},
        {"cov_yy", {"cov_yy"}},
        {"cov_yz", {"cov_yz"}},
        {"cov_zz", {"cov_zz"}},
        {"sigma_north", {"sigma_north", "sd_north", "sdn", "std_north", "sdnorth"}},
        {"sigma_east", {"sigma_east", "sd_east", "sde", "std_east", "sdeast"}},
        {"sigma_up", {"sigma_up", "sd_up", "sdu", "std_up", "sd_down", "sigma_down", "sd_height", "sdheight"}},
        {"quality", {"quality", "q", "fix"}},
        {"satellites", {"satellites", "n_sat", "nsat", "ns", "sats"}}},
       {{"time", "latitude", "longitude", "height"}, {"time", "x", "y", "z"}}},
      {TableKind::image_points,
       {{"image_column", {"image", "img", "photo", "frame"}},
        {"point_column", {"point", "point_id", "track", "track_id", "marker"}},
        {"x_column", {"x", "x_px", "u", "col", "column"}},
        {"y_column", {"y", "y_px", "v", "row", "line"}}},
       {{"image_column", "point_column", "x_column", "y_column"}}},
      {TableKind::event, {time_role, {"id", {"id", "event", "event_id", "image", "photo", "frame", "name"}}}, {{"time", "id"}}},
  };
  return list;
}

/// Of surveyed points. Letters beyond ASCII are as UTF-8 and as Latin-1 have them.
const std::vector<Role>& control_roles() {
  static const std::vector<Role> list{
      {"name", {"name", "p", "point", "id", "point_id", "pt", "punkt", "punktnummer", "punktnr", "punkt_nr", "pkt", "nr", "no", "number"}},
      {"x", {"x", "e", "east", "easting", "rechtswert", "rechts", "ost", "ostwert"}},
      {"y", {"y", "n", "north", "northing", "hochwert", "hoch", "nord", "nordwert"}},
      {"z", {"z", "h", "height", "elev", "elevation", "altitude", "alt", "hoehe", "h\xc3\xb6he", "h\xc3\x96he", "h\xf6he", "h\xd6he"}}};
  return list;
}

struct PlainName {
  std::string name, unit;
};

/// "lat_deg" and "Lat (deg)" are "lat" in deg; "H-Ell" is "h_ell".
PlainName plain_name(const std::string& given) {
  static constexpr std::array<std::string_view, 11> units{"deg", "rad", "degps", "radps", "mps2", "mps", "m2", "m", "s", "g", "ms"};
  std::string name = core::lower_case(given), unit;
  if (const size_t open = name.find_first_of("(["); open != name.npos && open > 0 && (name.back() == ')' || name.back() == ']')) {
    unit = name.substr(open + 1, name.size() - open - 2);
    name.resize(name.find_last_not_of(" _", open - 1) + 1);
  }
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == ' ' || c == '-'; }, '_');
  if (!unit.empty()) return {name, unit};
  const size_t cut = name.rfind('_');
  if (cut == std::string::npos || cut == 0) return {name, ""};
  const std::string ending = name.substr(cut + 1);
  if (std::find(units.begin(), units.end(), ending) == units.end()) return {name, ""};
  return {name.substr(0, cut), ending};
}

bool has_all(const ColumnRoles& found, const std::vector<std::string_view>& keys) {
  return std::all_of(keys.begin(), keys.end(), [&](std::string_view key) {
    return std::any_of(found.columns.begin(), found.columns.end(), [&](const auto& column) { return column.first == key; });
  });
}

/// Not both a geodetic and an ECEF position, nor both forms of accuracy: the first is kept.
void drop_second_form(ColumnRoles& found) {
  const auto drop = [&](std::initializer_list<std::string_view> keys) {
    std::erase_if(found.columns, [&](const auto& column) { return std::find(keys.begin(), keys.end(), column.first) != keys.end(); });
  };
  if (has_all(found, {"latitude", "longitude", "height"})) drop({"x", "y", "z"});
  if (has_all(found, {"cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz"}))
    drop({"sigma_north", "sigma_east", "sigma_up"});
  else
    drop({"cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz"});
  if (!has_all(found, {"sigma_north", "sigma_east", "sigma_up"})) drop({"sigma_north", "sigma_east", "sigma_up"});
}

/// Columns that mean something only together.
void drop_incomplete(ColumnRoles& found) {
  const std::vector<std::vector<std::string_view>> groups{
      {"v_north", "v_east", "v_down"}, {"sigma_north", "sigma_east", "sigma_down"}, {"sigma_roll", "sigma_pitch", "sigma_heading"}};
  for (const auto& group : groups)
    if (!has_all(found, group))
      std::erase_if(found.columns, [&](const auto& column) { return std::find(group.begin(), group.end(), column.first) != group.end(); });
}

/// Units that a survey.toml states or that are read as they are.
bool is_known_unit(std::string_view unit, std::string_view key) {
  static const std::set<std::string_view> known{"",       "deg",    "degrees", "rad",  "radians", "gon",   "degps", "radps",  "deg/s",
                                                "rad/s",  "mps",    "mps2",    "m/s",  "m/s2",    "m/s^2", "m2",    "m^2",    "m",
                                                "s",      "sec",    "seconds", "g",    "weeks",   "metre", "meter", "metres", "meters",
                                                "degree", "radian", "second",  "secs", "sow",     "week",  "-",     "none",   "m/s/s"};
  return known.contains(unit) || (unit == "ms" && key == "time");
}

/// What a column's name and unit say of its file.
void note_units(const PlainName& plain, std::string_view key, ColumnRoles& found) {
  if (!is_known_unit(plain.unit, key)) return;
  if (plain.unit.starts_with("deg") || plain.unit.starts_with("rad")) {
    const std::string unit = plain.unit.substr(0, 3);
    found.mixed_angles = found.mixed_angles || (!found.angle_unit.empty() && found.angle_unit != unit);
    found.angle_unit = unit;
  }
  const bool acceleration = key.starts_with("accelerometer"), gyro = key.starts_with("gyro");
  if (acceleration && (plain.unit.starts_with("mps") || plain.unit.starts_with("m/s"))) found.acceleration_unit = "m/s2";
  if (acceleration && plain.unit == "g") found.acceleration_unit = "g";
  if (gyro && (plain.name.starts_with("dtheta") || plain.name.starts_with("dangle"))) found.imu_kind = "increments";
  if (gyro && (plain.unit.ends_with("ps") || plain.unit.ends_with("/s"))) found.imu_kind = "rates";
  if (key != "time") return;
  if (plain.name.ends_with("sow") || plain.name.ends_with("tow") || plain.name.ends_with("of_week") || plain.name == "secofweek")
    found.time_scale = "gps_week";
  if (plain.name == "unix_time") found.time_scale = "unix";
  if (plain.unit == "ms") found.time_unit = "1 ms";
}

bool has_any(const std::vector<PlainName>& plain, std::initializer_list<std::string_view> names) {
  return std::any_of(plain.begin(), plain.end(),
                     [&](const PlainName& p) { return std::find(names.begin(), names.end(), p.name) != names.end(); });
}

/// Takes the column of the role's clearest name; by its number from 1 where the name stands more than once.
void take_column(const Role& role, const std::vector<std::string>& names, const std::vector<PlainName>& plain, ColumnRoles& found) {
  for (const std::string_view wanted : role.names) {
    const auto at = std::find_if(plain.begin(), plain.end(), [&](const PlainName& p) { return p.name == wanted; });
    if (at == plain.end()) continue;
    const auto c = static_cast<size_t>(at - plain.begin());
    const bool is_repeated = std::count(names.begin(), names.end(), names[c]) > 1;
    found.columns.emplace_back(role.key, is_repeated ? std::to_string(c + 1) : names[c]);
    if (!is_known_unit(at->unit, role.key)) found.foreign_units.push_back(names[c]);
    const bool may_be_of_the_sea = at->name.starts_with("alt") || at->name.starts_with("elev") || at->name == "z";
    if (role.key == "height" && may_be_of_the_sea && at->name.find("ell") == std::string::npos) found.altitude = names[c];
    return note_units(*at, role.key, found);
  }
}

/// A place on a map, where none on the globe is named: both coordinates by one way of naming them. Height may be Z beside X and Y.
void take_map_place(const std::vector<std::string>& names, const std::vector<PlainName>& plain, ColumnRoles& found) {
  const auto has = [&](std::string_view name) {
    return std::any_of(plain.begin(), plain.end(), [&](const PlainName& p) { return p.name == name; });
  };
  if (has_all(found, {"latitude"}) || has_all(found, {"longitude"})) return;
  for (const MapPair& pair : map_pairs) {
    if (!has(pair.northing) || !has(pair.easting)) continue;
    take_column({"latitude", {pair.northing}}, names, plain, found);
    take_column({"longitude", {pair.easting}}, names, plain, found);
    found.is_on_map = true;
    found.has_open_axes = pair.northing == "y";
    break;
  }
  if (found.is_on_map && !has_all(found, {"height"})) take_column({"height", {"z"}}, names, plain, found);
}

}  // namespace

ColumnRoles roles_of(const std::vector<std::string>& names, const std::vector<std::string>& units) {
  std::vector<PlainName> plain;
  for (const std::string& name : names) {
    plain.push_back(plain_name(name));
    if (plain.back().unit.empty() && plain.size() <= units.size()) plain.back().unit = units[plain.size() - 1];
  }
  for (const Kind& kind : kinds()) {
    // A distance beside a position or an attitude is the distance flown, and no range of a laser.
    const bool is_flown = !has_any(plain, {"range", "slant_range"}) && has_any(plain, {"latitude", "lat", "northing", "roll", "pitch"});
    if (kind.kind == TableKind::laser && is_flown) continue;
    ColumnRoles found;
    found.kind = kind.kind;
    for (const Role& role : kind.roles) take_column(role, names, plain, found);
    if (kind.kind == TableKind::trajectory) take_map_place(names, plain, found);
    found.has_rival_headings = kind.kind == TableKind::trajectory && !has_any(plain, {"heading", "true_heading", "hdg"}) &&
                               has_any(plain, {"yaw"}) && has_any(plain, {"azimuth"});
    if (found.mixed_angles) found.angle_unit.clear();
    if (std::none_of(kind.required.begin(), kind.required.end(), [&](const auto& keys) { return has_all(found, keys); })) continue;
    if (kind.kind == TableKind::gnss) drop_second_form(found);
    if (kind.kind == TableKind::trajectory) drop_incomplete(found);
    return found;
  }
  return {};
}

ColumnRoles roles_of_control(const std::vector<std::string>& names) {
  ColumnRoles found;
  std::vector<PlainName> plain;
  for (const std::string& name : names) plain.push_back(plain_name(name));
  for (const Role& role : control_roles()) {
    const auto count = [&](std::string_view wanted) {
      return std::count_if(plain.begin(), plain.end(), [&](const PlainName& p) { return p.name == wanted; });
    };
    std::ptrdiff_t all = 0;
    for (const std::string_view wanted : role.names) all += count(wanted);
    if (role.key == "name" || count(role.key) == 1 || (count(role.key) == 0 && all == 1)) take_column(role, names, plain, found);
  }
  if (has_all(found, {"x", "y", "z"})) found.kind = TableKind::control;
  return found;
}

}  // namespace swath::io
