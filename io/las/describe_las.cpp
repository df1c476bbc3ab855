// SPDX-License-Identifier: GPL-3.0-or-later
// Density is taken over the cells of 2 m (of the CRS's unit) that hold a point, so that voids and slanting strips do not lower it.
#include "io/las/describe_las.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_set>

#include "core/config/units.h"
#include "core/error.h"
#include "core/geo/crs.h"
#include "core/time.h"
#include "io/las/las_reader.h"

namespace swath::io {
namespace {

using core::Value;

constexpr size_t batch = 65536;
constexpr double cell = 2.0;

struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void add(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  Value value() const { return Value(Value::Array{low, high}); }
};

/// Number of a coordinate's cell, whose lowest 32 bits suffice: header and points may state places beyond any map.
std::uint64_t index_of(double coordinate) {
  constexpr double period = 4294967296.0;
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::fmod(std::floor(coordinate / cell), period))) & 0xffffffff;
}

/// What one pass over the points gathers.
struct Sums {
  std::array<Extent, 3> xyz;
  Extent time, angle;
  std::map<int, std::uint64_t> by_return, by_count, classes, lines;
  std::uint64_t points = 0, returns_inconsistent = 0, time_zero = 0, time_back = 0, withheld = 0, overlap = 0, first_returns = 0;
  double last_time = -std::numeric_limits<double>::infinity();
  std::unordered_set<std::uint64_t> cells;

  void add(const LasPoints& p) {
    points += p.size();
    for (size_t i = 0; i < p.size(); ++i) {
      xyz[0].add(p.x[i]);
      xyz[1].add(p.y[i]);
      xyz[2].add(p.z[i]);
      angle.add(p.scan_angle[i]);
      ++by_return[p.return_number[i]];
      ++by_count[p.return_count[i]];
      ++classes[p.classification[i]];
      ++lines[p.point_source_id[i]];
      first_returns += p.return_number[i] <= 1;
      returns_inconsistent += p.return_number[i] == 0 || p.return_number[i] > p.return_count[i];
      withheld += (p.flags[i] & core::flag::withheld) != 0;
      overlap += (p.flags[i] & core::flag::overlap) != 0;
      cells.insert(index_of(p.x[i]) << 32 | index_of(p.y[i]));
      if (p.gps_time.empty()) continue;
      time.add(p.gps_time[i]);
      time_zero += p.gps_time[i] == 0;
      time_back += p.gps_time[i] < last_time;
      last_time = p.gps_time[i];
    }
  }
};

Value counts(const std::map<int, std::uint64_t>& of) {
  Value out = Value::object();
  for (const auto& [key, n] : of) out[std::to_string(key)] = n;
  return out;
}

Value three(const Eigen::Vector3d& v) { return Value(Value::Array{v.x(), v.y(), v.z()}); }

void describe_crs(const LasReader& reader, Value& out, Value& warnings) {
  const LasCrs crs = reader.crs();
  if (!crs.note.empty()) warnings.push(crs.note);
  if (crs.definition.empty()) {
    warnings.push("the file states no CRS");
    return;
  }
  try {
    const core::Crs known(crs.definition);
    out["crs"] = known.name();
    if (known.epsg()) out["epsg"] = known.epsg();
    out["unit"] = known.unit_name();
    out["heights"] = known.vertical_name();
    if (known.is_geographic()) warnings.push("coordinates are degrees: density and cells have no meaning");
  } catch (const core::Error& e) {
    warnings.push("the CRS that the file states is not known: " + std::string(e.what()));
  }
}

void describe_time(const LasHeader& h, const Sums& s, Value& out, Value& warnings) {
  if (s.points == 0 || !(s.time.low <= s.time.high)) return;
  Value& time = out["time"] = Value::object();
  time["scale"] = h.gps_time_is_adjusted() ? "adjusted standard GPS time (GPS seconds - 1e9)" : "seconds of the GPS week";
  time["span"] = s.time.value();
  if (h.gps_time_is_adjusted()) {
    time["from"] = core::utc_text(s.time.low + core::adjusted_offset);
    time["to"] = core::utc_text(s.time.high + core::adjusted_offset);
    if (s.time.low >= 0 && s.time.high < core::seconds_per_week && s.time.high > 0)
      warnings.push("times are said to be adjusted standard GPS time but look like seconds of the week");
  } else {
    warnings.push("GPS time is seconds of the week, and the file does not say of which week");
    if (s.time.low < 0 || s.time.high >= 2 * core::seconds_per_week)
      warnings.push("times lie outside a week: the time scale is stated wrongly");
  }
  if (s.time_zero == s.points)
    warnings.push("all times are 0");
  else if (s.time_zero > 0)
    warnings.push(std::to_string(s.time_zero) + " points have time 0");
  if (s.time_back > 0) time["steps_back"] = s.time_back;
}

}  // namespace

core::Value describe_las(const std::filesystem::path& file) {
  LasReader reader(file);
  const LasHeader& h = reader.header();
  Sums s;
  LasPoints points;
  while (reader.read(points, batch) > 0) s.add(points);

  Value out = Value::object(), warnings = Value::array();
  for (const std::string& w : reader.warnings()) warnings.push(w);
  out["format"] = h.compressed ? "LAZ" : "LAS";
  out["version"] = std::to_string(h.version_major) + "." + std::to_string(h.version_minor);
  out["point_format"] = h.point_format;
  out["points"] = s.points;
  out["system"] = h.system_identifier;
  out["software"] = h.generating_software;
  if (h.creation_year) out["created"] = std::to_string(h.creation_year) + ", day " + std::to_string(h.creation_day);
  out["scale"] = three(h.scale);
  describe_crs(reader, out, warnings);
  if (s.points == 0) {
    warnings.push("the file has no points");
    out["warnings"] = std::move(warnings);
    return out;
  }
  out["x"] = s.xyz[0].value();
  out["y"] = s.xyz[1].value();
  out["z"] = s.xyz[2].value();
  for (int k = 0; k < 3; ++k) {
    const Extent& e = s.xyz[static_cast<size_t>(k)];
    if (std::abs(h.min[k] - e.low) > h.scale[k] || std::abs(h.max[k] - e.high) > h.scale[k])
      warnings.push(std::string("the header states ") + "xyz"[k] + " " + core::format_number(h.min[k]) + " to " +
                    core::format_number(h.max[k]) + ", the points span " + core::format_number(e.low) + " to " +
                    core::format_number(e.high));
  }
  describe_time(h, s, out, warnings);
  out["returns"] = counts(s.by_return);
  out["returns_per_pulse"] = counts(s.by_count);
  out["classes"] = counts(s.classes);
  out["lines"] = counts(s.lines);
  out["scan_angle_deg"] = s.angle.value();
  if (s.withheld) out["withheld"] = s.withheld;
  if (s.overlap) out["overlap"] = s.overlap;
  const double area = static_cast<double>(s.cells.size()) * cell * cell;
  out["covered_area"] = area;
  out["points_per_square_unit"] = static_cast<double>(s.points) / area;
  out["first_returns_per_square_unit"] = static_cast<double>(s.first_returns) / area;
  if (!h.extras.empty()) {
    Value names = Value::array();
    for (const LasExtra& e : h.extras) names.push(e.name);
    out["extra_fields"] = std::move(names);
  }
  if (s.by_return.size() == 1 && s.by_return.begin()->first == 0)
    warnings.push("no point has a return number");
  else if (s.returns_inconsistent)
    warnings.push(std::to_string(s.returns_inconsistent) + " points have a return number of 0 or above the pulse's count");
  for (size_t r = 1; r <= h.by_return.size(); ++r) {
    const auto at = s.by_return.find(static_cast<int>(r));
    const std::uint64_t n = at == s.by_return.end() ? 0 : at->second;
    if (h.by_return[r - 1] != n && h.by_return[r - 1] != 0)
      warnings.push("the header states " + std::to_string(h.by_return[r - 1]) + " points of return " + std::to_string(r) + ", there are " +
                    std::to_string(n));
  }
  if (s.angle.low == s.angle.high) warnings.push("all scan angles are " + core::format_number(s.angle.low));
  out["warnings"] = std::move(warnings);
  return out;
}

}  // namespace swath::io
