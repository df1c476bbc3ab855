// SPDX-License-Identifier: GPL-3.0-or-later
// Density is taken over the cells of 2 m (of the CRS's unit) that hold a point, so that voids and slanting strips do not lower it.
#include "io/las/describe_las.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <unordered_set>
#include <vector>

#include "core/config/result_visitors.h"
#include "core/config/units.h"
#include "core/error.h"
#include "core/time.h"
#include "io/copc/copc_hierarchy.h"
#include "io/las/las_reader.h"
#include "io/store/address.h"
#include "io/survey/file_facts.h"

namespace swath::io {
namespace {

constexpr size_t batch = 65536;
constexpr double cell = 2.0;
constexpr double full_cell = 4.0;  // points in the mean of cells that hold one: 1 in 50 of a covered area is empty by chance

/// Number of a coordinate's cell, whose lowest 32 bits suffice: header and points may state places beyond any map.
std::uint64_t index_of(double coordinate) {
  constexpr double period = 4294967296.0;
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::fmod(std::floor(coordinate / cell), period))) & 0xffffffff;
}

/// What one pass over the points gathers.
struct Sums {
  std::array<core::Interval, 3> xyz;
  core::Interval time, angle;
  std::map<int, std::uint64_t> by_return, by_count, classes, lines;
  std::uint64_t looked_at = 0, twice = 0;  ///< of the first points: those that repeat another one
  bool looked_at_times = false;            ///< not all of one time
  std::uint64_t points = 0, returns_inconsistent = 0, time_zero = 0, time_back = 0, withheld = 0, overlap = 0, first_returns = 0;
  double last_time = -std::numeric_limits<double>::infinity();
  std::unordered_set<std::uint64_t> cells;

  /// Points with the place, return number and time of another; without times two returns at one place differ by their intensity.
  void find_twice(const LasPoints& p) {
    looked_at_times = std::any_of(p.gps_time.begin(), p.gps_time.end(), [&](double t) { return t != p.gps_time[0]; });
    std::vector<std::array<double, 5>> rows;
    for (size_t i = 0; i < p.size(); ++i)
      rows.push_back({p.x[i], p.y[i], p.z[i], looked_at_times ? p.gps_time[i] : p.intensity[i], static_cast<double>(p.return_number[i])});
    std::sort(rows.begin(), rows.end());
    looked_at = rows.size();
    for (size_t i = 1; i < rows.size(); ++i) twice += rows[i] == rows[i - 1];
  }

  void add(const LasPoints& p) {
    if (points == 0) find_twice(p);
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

/// Area of the cells that hold a point. Sparse points, and those of a CRS in feet, leave many cells of a covered area empty: the cells are
/// doubled until they are full. No more than the box of the points and a cell about it.
double covered_area(const Sums& s) {
  std::unordered_set<std::uint64_t> cells = s.cells;
  double side = cell;
  while (cells.size() > 1 && static_cast<double>(s.points) < full_cell * static_cast<double>(cells.size())) {
    std::unordered_set<std::uint64_t> wider;
    for (const std::uint64_t c : cells) wider.insert((c >> 33) << 32 | (c & 0xffffffff) >> 1);
    cells = std::move(wider);
    side *= 2;
  }
  const double box = (s.xyz[0].high - s.xyz[0].low + cell) * (s.xyz[1].high - s.xyz[1].low + cell);
  return std::min(static_cast<double>(cells.size()) * side * side, box);
}

/// GPS times of the points.
struct LasTimes {
  std::string scale;
  core::Interval span;
  std::optional<std::string> from, to;
  std::uint64_t steps_back = 0;
};
template <class V>
void describe(const LasTimes& r, V& v) {
  v.result("scale", r.scale, "Time scale that the header states.");
  v.result("span", r.span, "First and last time, in the file's scale.");
  v.result("from", r.from, "UTC of the first.");
  v.result("to", r.to, "UTC of the last.");
  v.result("steps_back", r.steps_back, core::if_any(), "Points whose time is before that of the point before.");
}

/// The octree of a LAZ that is COPC.
struct CopcFacts {
  size_t nodes = 0;
  int levels = 0;
  double spacing = 0.0;
};
template <class V>
void describe(const CopcFacts& r, V& v) {
  v.result("nodes", r.nodes, "Nodes of the octree that hold points.");
  v.result("levels", r.levels, "Levels of the octree.");
  v.result("spacing", r.spacing, "Distance between points of the root, in units of the coordinates.");
}

struct LasFacts {
  const LasHeader& h;
  const Sums& s;
  StatedCrs crs;
  std::optional<LasTimes> time;
  std::vector<std::string> warnings;
  std::optional<CopcFacts> copc{};
  bool is_whole = true;  ///< false: the points were not read
};
template <class V>
void describe(const LasFacts& r, V& v) {
  const LasHeader& h = r.h;
  const bool any = r.is_whole && r.s.points > 0;
  const core::Form where_any = core::Form{}.only_if(any);
  const double area = r.s.points > 0 ? covered_area(r.s) : 0.0;
  std::vector<std::string> extras;
  for (const LasExtra& e : h.extras) extras.push_back(e.name);
  v.result("format", std::string(r.copc ? "COPC (LAZ)" : h.compressed ? "LAZ" : "LAS"), "Format.");
  v.result("version", std::to_string(h.version_major) + "." + std::to_string(h.version_minor), "Version of LAS.");
  v.result("point_format", h.point_format, "Point format.");
  v.result("points", r.is_whole ? r.s.points : h.point_count, "Points.");
  v.result("system", h.system_identifier, "System that the header names.");
  v.result("software", h.generating_software, "Software that the header names.");
  v.result("created", std::to_string(h.creation_year) + ", day " + std::to_string(h.creation_day),
           core::Form{}.only_if(h.creation_year != 0), "Year and day of the file's creation.");
  v.result("scale", h.scale, "Resolution of the coordinates.");
  describe(r.crs, v);
  v.result("x", r.s.xyz[0], "Smallest and largest x of the points.");
  v.result("y", r.s.xyz[1], "Smallest and largest y.");
  v.result("z", r.s.xyz[2], "Smallest and largest z.");
  v.table("time", r.time, "GPS times of the points.");
  v.table("copc", r.copc, "Octree of a COPC file.");
  v.tables_if(any || !r.s.by_return.empty(), "returns", core::counts_of(r.s.by_return), "Points by their return number.");
  v.tables_if(any, "returns_per_pulse", core::counts_of(r.s.by_count), "Points by the number of returns of their pulse.");
  v.tables_if(any, "classes", core::counts_of(r.s.classes), "Points by their ASPRS class.");
  v.tables_if(any, "lines", core::counts_of(r.s.lines), "Points by their point source id.");
  v.result("scan_angle_deg", r.s.angle, core::Form{}.only_if(r.is_whole), "Smallest and largest scan angle.");
  v.result("withheld", r.s.withheld, core::if_any(), "Points flagged as withheld.");
  v.result("overlap", r.s.overlap, core::if_any(), "Points flagged as overlap.");
  v.result("covered_area", area, where_any, "Area of the cells that hold a point: 2 units wide, or wider until they hold 4 in the mean.");
  v.result("points_per_square_unit", static_cast<double>(r.s.points) / area, where_any, "Points per square unit of that area.");
  v.result("first_returns_per_square_unit", static_cast<double>(r.s.first_returns) / area, where_any, "First returns per square unit.");
  v.result("extra_fields", extras, core::Form{}.only_if(!extras.empty() && (any || !r.is_whole)), "Names of the extra fields.");
  v.result("read", std::string("header alone: times, classes, lines and density need all points, fetch the file for them"),
           core::Form{}.only_if(!r.is_whole), "What of an object in a store was read.");
  v.result("warnings", r.warnings, "What looks wrong.");
}

void find_crs(const LasCrs& crs, LasFacts& out) {
  if (!crs.note.empty()) out.warnings.push_back(crs.note);
  if (crs.definition.empty()) return out.warnings.push_back("the file states no CRS");
  try {
    const core::Crs known(crs.definition);
    out.crs = StatedCrs(known);
    if (known.is_geographic()) out.warnings.push_back("coordinates are degrees: density and cells have no meaning");
  } catch (const core::Error& e) {
    out.warnings.push_back("the CRS that the file states is not known: " + std::string(e.what()));
  }
}

void judge_times(LasFacts& out) {
  const Sums& s = out.s;
  if (s.points == 0 || !s.time.any()) return;
  LasTimes& time = out.time.emplace(LasTimes{"seconds of the GPS week", s.time, {}, {}, s.time_back});
  if (out.h.gps_time_is_adjusted()) {
    time.scale = "adjusted standard GPS time (GPS seconds - 1e9)";
    time.from = core::utc_text(s.time.low + core::adjusted_offset);
    time.to = core::utc_text(s.time.high + core::adjusted_offset);
    if (s.time.low >= 0 && s.time.high < core::seconds_per_week && s.time.high > 0)
      out.warnings.push_back("times are said to be adjusted standard GPS time but look like seconds of the week");
  } else {
    out.warnings.push_back("GPS time is seconds of the week, and the file does not say of which week");
    if (s.time.low < 0 || s.time.high >= 2 * core::seconds_per_week)
      out.warnings.push_back("times lie outside a week: the time scale is stated wrongly");
  }
  if (s.time_zero == s.points)
    out.warnings.push_back("all times are 0");
  else if (s.time_zero > 0)
    out.warnings.push_back(std::to_string(s.time_zero) + (s.time_zero == 1 ? " point has time 0" : " points have time 0"));
}

/// The header's box and counts against the points.
void judge_header(LasFacts& out) {
  const LasHeader& h = out.h;
  for (int k = 0; k < 3; ++k) {
    const core::Interval& e = out.s.xyz[static_cast<size_t>(k)];
    if (std::abs(h.min[k] - e.low) > std::abs(h.scale[k]) || std::abs(h.max[k] - e.high) > std::abs(h.scale[k]))
      out.warnings.push_back(std::string("the header states ") + "xyz"[k] + " " + core::format_number(h.min[k], 12) + " to " +
                             core::format_number(h.max[k], 12) + ", the points span " + core::format_number(e.low, 12) + " to " +
                             core::format_number(e.high, 12));
  }
}

/// A file that was merged from others may have points twice; a few points at one place are chance.
void judge_repeated(LasFacts& out) {
  constexpr std::uint64_t one_in = 1000;
  const Sums& s = out.s;
  if (s.twice * one_in < s.looked_at || s.twice == 0) return;
  const std::string of = "of the first " + core::counted(s.looked_at, "point") + " ",
                    share = core::counted(s.twice, of + "has", of + "have");
  out.warnings.push_back(
      share + (s.looked_at_times ? " the place, time and return number of another: the file has points twice"
                                 : " the place, intensity and return number of another: the file, without times, may have points twice"));
}

void judge_returns(LasFacts& out) {
  const Sums& s = out.s;
  if (s.by_return.size() == 1 && s.by_return.begin()->first == 0)
    out.warnings.push_back("no point has a return number");
  else if (s.returns_inconsistent)
    out.warnings.push_back(core::counted(s.returns_inconsistent, "point has", "points have") +
                           " a return number of 0 or above the pulse's count");
  for (size_t r = 1; r <= out.h.by_return.size(); ++r) {
    const std::uint64_t stated = out.h.by_return[r - 1];
    const auto at = s.by_return.find(static_cast<int>(r));
    const std::uint64_t n = at == s.by_return.end() ? 0 : at->second;
    if (stated != n && stated != 0)
      out.warnings.push_back("the header states " + core::counted(stated, "point") + " of return " + std::to_string(r) + ", there are " +
                             std::to_string(n));
  }
  if (s.angle.low == s.angle.high) out.warnings.push_back("all scan angles are " + core::format_number(s.angle.low, 6));
}

/// Readers that stream find points by the hierarchy alone: where it is broken, the points that a plain reader sees are not all there.
void find_octree(const std::filesystem::path& file, LasFacts& out) {
  try {
    const auto info = copc_info(out.h, file);
    if (!info) return;
    CopcFacts& copc = out.copc.emplace(CopcFacts{0, 0, info->spacing});
    for (const CopcNode& n : read_copc_nodes(file, out.h, *info)) ++copc.nodes, copc.levels = std::max(copc.levels, n.key.level + 1);
  } catch (const core::Error& e) {
    out.copc.reset();
    out.warnings.push_back("it is a COPC file, but " + std::string(e.what()) + " (" + e.where() + ")");
  }
}

/// An object of a store by its header and the pages of its octree: its points may be gigabytes away.
core::Value describe_stored(const std::filesystem::path& address) {
  std::vector<std::string> warnings;
  const LasHeader h = read_las_header(address, warnings);
  Sums stated;
  for (size_t k = 0; k < 3 && h.point_count > 0; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    for (const double at : {h.min[axis], h.max[axis]}) stated.xyz[k].add(at);
  }
  for (size_t r = 0; r < h.by_return.size(); ++r)
    if (h.by_return[r] > 0) stated.by_return[static_cast<int>(r) + 1] = h.by_return[r];
  LasFacts out{h, stated, {}, {}, std::move(warnings), {}, false};
  find_crs(las_crs(h), out);
  find_octree(address, out);
  if (h.point_count == 0) out.warnings.push_back("the file has no points");
  return core::reported(out);
}

}  // namespace

core::Value describe_las(const std::filesystem::path& file) {
  if (is_address(file)) return describe_stored(file);
  LasReader reader(file);
  Sums s;
  LasPoints points;
  while (reader.read(points, batch) > 0) s.add(points);
  LasFacts out{reader.header(), s, {}, {}, reader.warnings()};
  find_crs(reader.crs(), out);
  find_octree(file, out);
  if (s.points == 0) {
    out.warnings.push_back("the file has no points");
    return core::reported(out);
  }
  judge_header(out);
  judge_times(out);
  judge_returns(out);
  judge_repeated(out);
  return core::reported(out);
}

}  // namespace swath::io
