// SPDX-License-Identifier: GPL-3.0-or-later
// Points are taken by the nearest piece of the line at right angles to which they lie; the terrain is read bilinearly every half cell.
#include "pipeline/profile.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <tuple>

#include "core/block.h"
#include "core/error.h"
#include "core/geo/height_unit.h"
#include "core/geo/same_map.h"
#include "core/printable.h"
#include "io/las/cloud_crs.h"
#include "io/las/las_crs.h"
#include "io/las/las_ending.h"
#include "io/las/las_reader.h"
#include "io/raster/geotiff.h"
#include "io/raster/height_file.h"
#include "io/raster/png.h"
#include "io/text/output_file.h"
#include "pipeline/input_guard.h"
#include "pipeline/surface_file.h"
#include "report/chart.h"
#include "report/volumes.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using Point = Eigen::Vector2d;

constexpr size_t batch = 1 << 17;
constexpr const char* no_points = "no point of the clouds lies within the half width of the line; are both of the same place?";
constexpr size_t window_cells = 1 << 20;  // of the terrain model that is held at a time

struct Sample {
  double station = 0.0, offset = 0.0, x = 0.0, y = 0.0, z = 0.0;  ///< offset to the right of the line
  double sigma = std::numeric_limits<double>::quiet_NaN();
  int point_class = -1;
};

struct Section {
  const ProfileLine* line = nullptr;
  std::vector<double> start;  ///< length of the line before each vertex
  Point low, high;            ///< of the strip
  std::vector<Sample> points, terrain;
  double length() const { return start.back(); }
};

Section section_of(const ProfileLine& line, double half_width) {
  Section s;
  s.line = &line;
  s.start.assign(line.vertices.size(), 0.0);
  s.low = s.high = line.vertices[0];
  for (size_t k = 1; k < line.vertices.size(); ++k) {
    s.start[k] = s.start[k - 1] + (line.vertices[k] - line.vertices[k - 1]).norm();
    s.low = s.low.cwiseMin(line.vertices[k]);
    s.high = s.high.cwiseMax(line.vertices[k]);
  }
  s.low.array() -= half_width;
  s.high.array() += half_width;
  return s;
}

/// Station and offset by the nearest piece of the line whose strip holds the point; offset NaN where none does.
Sample projected(const Section& s, const Point& p, double half_width) {
  Sample best;
  best.offset = std::numeric_limits<double>::quiet_NaN();
  const auto& v = s.line->vertices;
  for (size_t k = 1; k < v.size(); ++k) {
    const Point d = v[k] - v[k - 1];
    const double length = d.norm();
    if (length == 0.0) continue;
    const Point r = p - v[k - 1];
    const double along = r.dot(d) / length, aside = (r.x() * d.y() - r.y() * d.x()) / length;
    if (along < 0.0 || along > length || std::abs(aside) > half_width || std::abs(aside) >= std::abs(best.offset)) continue;
    best.station = s.start[k - 1] + along;
    best.offset = aside;
  }
  best.x = p.x();
  best.y = p.y();
  return best;
}

std::vector<fs::path> las_files(const std::vector<fs::path>& given) {
  std::vector<fs::path> out;
  for (const fs::path& p : given) {
    if (!fs::is_directory(p)) {
      out.push_back(p);
      continue;
    }
    const size_t before = out.size();
    for (const auto& e : fs::directory_iterator(p))
      if (io::has_las_ending(e.path())) out.push_back(e.path());
    if (out.size() == before) throw core::Error("the folder holds no LAS or LAZ file", p.string());
    std::sort(out.begin() + static_cast<std::ptrdiff_t>(before), out.end());
  }
  return out;
}

void take_points(const fs::path& file, double half_width, std::vector<Section>& sections) {
  io::LasReader reader(file);
  const io::LasHeader& h = reader.header();
  const auto touches = [&](const Section& s) {
    return h.min.x() <= s.high.x() && h.max.x() >= s.low.x() && h.min.y() <= s.high.y() && h.max.y() >= s.low.y();
  };
  if (std::none_of(sections.begin(), sections.end(), touches)) return;
  core::Block block;
  io::LasTime time;
  time.keep_unknown = true;
  while (reader.read(block, batch, time) > 0)
    for (size_t i = 0; i < block.size(); ++i) {
      if (!core::is_usable(block, i)) continue;
      const Point p(block.x[i] + block.origin.x(), block.y[i] + block.origin.y());
      for (Section& s : sections) {
        if ((p.array() < s.low.array()).any() || (p.array() > s.high.array()).any()) continue;
        Sample one = projected(s, p, half_width);
        if (std::isnan(one.offset)) continue;
        one.z = block.z[i] + block.origin.z();
        one.point_class = block.classification.empty() ? 0 : block.classification[i];
        s.points.push_back(one);
      }
    }
}

/// The share of the way from p to q, first and last, that lies within low and high; first above last: none does.
std::pair<double, double> within(const Point& p, const Point& q, const Point& low, const Point& high) {
  double first = 0.0, last = 1.0;
  for (int k = 0; k < 2; ++k) {
    const double d = q[k] - p[k];
    if (d == 0.0) {
      if (p[k] < low[k] || p[k] > high[k]) return {1.0, 0.0};
      continue;
    }
    const double a = (low[k] - p[k]) / d, b = (high[k] - p[k]) / d;
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  return {first, last};
}

/// The model along the line, every half cell and at the line's end, where the line is over it; read in windows of at most `window_cells`
/// cells. Beside the model lies one sample without a height, so that a chart shows the gap.
void take_terrain(const fs::path& file, Section& s) {
  const core::Lattice whole = io::lattice_of(io::read_raster_info(file), file);
  const double step = 0.5 * whole.cell;
  const Point low_corner(whole.west() - whole.cell, whole.south() - whole.cell),
      high_corner(whole.east() + whole.cell, whole.north() + whole.cell);
  for (size_t piece = 1; piece < s.start.size(); ++piece) {
    const Point &p = s.line->vertices[piece - 1], &q = s.line->vertices[piece];
    const double span = s.start[piece] - s.start[piece - 1];
    const bool is_last = piece + 1 == s.start.size();
    const auto sample_at = [&](double station, bool known) {
      const Point at = p + (station - s.start[piece - 1]) / span * (q - p);
      Sample one;
      one.station = station;
      one.x = at.x();
      one.y = at.y();
      if (!known) one.x = one.y = std::numeric_limits<double>::quiet_NaN();
      s.terrain.push_back(one);
    };
    if (!(span > 0.0)) continue;
    const auto [first, last] = within(p, q, low_corner, high_corner);
    if (!(first <= last)) continue;
    // Stations are whole steps from the line's start, so that they do not depend on its vertices.
    const double begin = s.start[piece - 1] + first * span, end = s.start[piece - 1] + last * span;
    if (first > 0.0) sample_at(begin, false);
    for (double n = std::ceil(begin / step); n * step <= end; ++n)
      if (piece == 1 || n * step > s.start[piece - 1]) sample_at(n * step, true);
    if (is_last && last == 1.0 && (s.terrain.empty() || s.terrain.back().station < s.start[piece])) sample_at(s.start[piece], true);
    if (last < 1.0) sample_at(end, false);
  }
  const auto around = [&](const Point& low, const Point& high) {
    return core::lattice_of(whole.cell, low.x() - whole.cell, low.y() - whole.cell, high.x() + whole.cell, high.y() + whole.cell);
  };
  for (size_t first = 0, last; first < s.terrain.size(); first = last) {
    Point low(s.terrain[first].x, s.terrain[first].y), high = low;
    last = first + 1;
    if (std::isnan(low.x())) {  // beside the model
      s.terrain[first].z = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    for (; last < s.terrain.size() && !std::isnan(s.terrain[last].x); ++last) {
      const Point p(s.terrain[last].x, s.terrain[last].y), new_low = low.cwiseMin(p), new_high = high.cwiseMax(p);
      if (around(new_low, new_high).size() > window_cells) break;
      low = new_low;
      high = new_high;
    }
    const core::Lattice needed = around(low, high);
    const bool meets = needed.i0 < whole.i0 + whole.nx && needed.i0 + needed.nx > whole.i0 && needed.j0 < whole.j0 + whole.ny &&
                       needed.j0 + needed.ny > whole.j0;
    const core::Grid grid = meets ? read_surface(file, needed).grid : core::Grid(needed);
    for (size_t n = first; n < last; ++n) {
      const report::GridSample at = report::sample(grid, s.terrain[n].x, s.terrain[n].y);
      s.terrain[n].z = at.height;
      s.terrain[n].sigma = at.sigma;
    }
  }
}

std::string class_name(int c) {
  static const std::map<int, std::string> names{{0, "never classified"},
                                                {1, "unassigned"},
                                                {2, "ground"},
                                                {3, "low vegetation"},
                                                {4, "medium vegetation"},
                                                {5, "high vegetation"},
                                                {6, "building"},
                                                {9, "water"},
                                                {10, "rail"},
                                                {11, "road"},
                                                {14, "wire"},
                                                {15, "tower"},
                                                {17, "bridge deck"}};
  const auto at = names.find(c);
  return at == names.end() ? "class " + std::to_string(c) : at->second;
}

report::Chart chart_of(const Section& s, const std::string& unit, const std::string& height_unit) {
  report::Panel panel;
  panel.x_label = "distance along the profile (" + unit + ")";
  panel.y_label = "height (" + height_unit + ")";
  report::Series band, line{"terrain model", {}, {}, {}, report::Mark::line, -1};
  band.name = "terrain model, 1 sigma";
  band.mark = report::Mark::band;
  bool sigma = false;
  for (const Sample& t : s.terrain) {
    line.x.push_back(t.station);
    line.y.push_back(t.z);
    band.x.push_back(t.station);
    band.y.push_back(t.z - t.sigma);
    band.y2.push_back(t.z + t.sigma);
    sigma = sigma || !std::isnan(t.sigma + t.z);
  }
  if (sigma) panel.series.push_back(std::move(band));
  std::map<int, report::Series> classes;
  for (const Sample& p : s.points) {
    report::Series& one = classes[p.point_class];
    one.name = class_name(p.point_class);
    one.mark = report::Mark::dots;
    one.x.push_back(p.station);
    one.y.push_back(p.z);
  }
  for (auto& [c, one] : classes) panel.series.push_back(std::move(one));
  if (!line.x.empty()) panel.series.push_back(std::move(line));
  report::Chart chart;
  chart.title = s.line->name;
  chart.panel_height = 420;
  chart.panels.push_back(std::move(panel));
  return chart;
}

std::string table_of(const Section& s) {
  std::string out = "kind,station,offset,x,y,z,sigma,class\n";
  char row[240];
  for (const auto* samples : {&s.terrain, &s.points})
    for (const Sample& p : *samples) {
      const bool terrain = p.point_class < 0;
      if (terrain && std::isnan(p.z)) continue;
      std::snprintf(row, sizeof row, "%s,%.3f,%.3f,%.3f,%.3f,%.3f,", terrain ? "terrain" : "point", p.station, p.offset, p.x, p.y, p.z);
      out += row;
      if (!std::isnan(p.sigma)) {
        std::snprintf(row, sizeof row, "%.4f", p.sigma);
        out += row;
      }
      out += terrain ? ",\n" : "," + std::to_string(p.point_class) + "\n";
    }
  return out;
}

/// The system of one file; nothing where it states none.
struct StatedCrs {
  fs::path file;
  core::Crs crs;
  double height_unit = 1.0;
};

StatedCrs crs_of_cloud(const fs::path& file) {
  std::vector<std::string> ignored;
  const io::LasCrs stated = io::las_crs(io::read_las_header(file, ignored));
  if (stated.definition.empty()) return {file, {}, stated.vertical_metres > 0.0 ? stated.vertical_metres : 1.0};
  const core::Crs crs(stated.definition);
  const double unit = crs.has_height_unit()          ? crs.vertical_metres_per_unit()
                      : stated.vertical_metres > 0.0 ? stated.vertical_metres
                      : crs.is_geographic()          ? 1.0
                                                     : crs.metres_per_unit();
  return {file, crs, unit};
}

StatedCrs crs_of_model(const fs::path& file) {
  const std::string wkt = io::read_raster_info(file).crs_wkt;
  return {file, wkt.empty() ? core::Crs() : core::Crs(wkt), io::height_unit_of(file)};
}

/// Heights of which one file does not state the system are taken as those of the other, as long as their units agree.
bool is_one_system(const StatedCrs& a, const StatedCrs& b) {
  if (std::abs(a.height_unit / b.height_unit - 1.0) > 1e-9) return false;
  if (core::is_same_crs(a.crs, b.crs)) return true;
  return core::is_same_crs(a.crs.horizontal(), b.crs.horizontal()) && !core::are_heights_apart(a.crs, b.crs);
}

std::string named(const StatedCrs& s) {
  return s.crs.name() + " (" + s.crs.unit_name() + ", heights in " + core::unit_symbol(s.height_unit) + ")";
}

/// The one system of all files that state one, the model before the clouds. Throws core::Error where there are two.
StatedCrs common_crs(const ProfileRequest& request, const std::vector<fs::path>& files) {
  std::vector<StatedCrs> all;
  if (!request.dtm.empty()) all.push_back(crs_of_model(request.dtm));
  for (const fs::path& file : files) all.push_back(crs_of_cloud(file));
  const auto first = std::find_if(all.begin(), all.end(), [](const StatedCrs& s) { return !s.crs.empty(); });
  if (first == all.end()) return all.front();
  for (const StatedCrs& one : all)
    if (!one.crs.empty() && !is_one_system(one, *first))
      throw core::usage_error("is in " + named(one) + ", while " + first->file.string() + " is in " + named(*first) +
                                  ": a section needs one coordinate reference system and one unit",
                              one.file.string(), "bring clouds to one with `swath classify FILES --crs EPSG:...`, or cut each alone");
  return *first;
}

/// No file that is read is written over.
void check_names(const ProfileRequest& request, std::vector<fs::path> read, const std::vector<ProfileLine>& lines) {
  read.insert(read.end(), {request.dtm, request.lines});
  const InputGuard guard(read);
  for (const ProfileLine& line : lines)
    for (const char* ending : {".csv", ".svg", ".png"}) guard.expect_apart(request.folder / (line.name + ending));
}

}  // namespace

std::vector<ProfileFound> write_profiles(const ProfileRequest& request) {
  const std::vector<fs::path> files = las_files(request.points);
  if (files.empty() && request.dtm.empty())
    throw core::usage_error("neither points nor a terrain model are named", "swath profile", "name LAS files or folders, or --dtm FILE");
  const StatedCrs system = common_crs(request, files);
  const core::Crs& crs = system.crs;
  const std::vector<ProfileLine> lines = profile_lines(request, crs);
  check_names(request, files, lines);
  const bool metric = crs.empty() || crs.metres_per_unit() == 0.0;
  const double half_width = request.half_width / (metric ? 1.0 : crs.metres_per_unit());
  const std::string unit = metric ? "m" : core::unit_symbol(crs.metres_per_unit()), height_unit = core::unit_symbol(system.height_unit);

  std::vector<Section> sections;
  for (const ProfileLine& line : lines) sections.push_back(section_of(line, half_width));
  for (const fs::path& file : files) take_points(file, half_width, sections);
  std::vector<ProfileFound> found;
  for (Section& s : sections) {
    if (!request.dtm.empty()) take_terrain(request.dtm, s);
    const auto known = std::count_if(s.terrain.begin(), s.terrain.end(), [](const Sample& t) { return !std::isnan(t.z); });
    if (s.points.empty() && known == 0)
      throw core::Error("the line '" + s.line->name + "' meets neither points nor terrain", request.lines.string(),
                        "are its coordinates those of the data's CRS?");
    std::sort(s.points.begin(), s.points.end(), [](const Sample& a, const Sample& b) {
      return std::tie(a.station, a.offset, a.z, a.point_class) < std::tie(b.station, b.offset, b.z, b.point_class);
    });
    const report::Chart chart = chart_of(s, unit, height_unit);
    fs::create_directories(request.folder);
    io::write_text_file(request.folder / (s.line->name + ".csv"), table_of(s));
    io::write_text_file(request.folder / (s.line->name + ".svg"), report::svg(chart));
    io::write_png(request.folder / (s.line->name + ".png"), report::draw(chart));
    found.push_back({s.line->name, s.length(), s.line->left_out, s.points.size(), static_cast<size_t>(known),
                     !files.empty() && s.points.empty() ? no_points : std::string()});
  }
  return found;
}

}  // namespace swath::pipeline
