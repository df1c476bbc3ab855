// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/measures/cross_sections.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/error.h"
#include "core/geo/map_axes.h"
#include "core/geo/same_map.h"
#include "core/printable.h"
#include "io/raster/geotiff.h"
#include "io/raster/height_file.h"
#include "io/text/output_file.h"
#include "pipeline/input_guard.h"
#include "pipeline/surface_file.h"
#include "report/volumes.h"

namespace swath::pipeline {
namespace {

using Eigen::Vector2d;
constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr const char *sections_name = "sections.csv", *section_points_name = "section_points.csv";

/// A raster that is read where a section lies.
struct Model {
  std::filesystem::path file;
  core::Lattice lattice;
  core::Crs crs;
  double unit = 1.0;  ///< m per unit of height

  explicit Model(const std::filesystem::path& f) : file(f) {
    const io::RasterInfo info = io::read_raster_info(f);
    lattice = io::lattice_of(info, f);
    if (!info.crs_wkt.empty()) crs = core::Crs(info.crs_wkt);
    core::require_easting_northing(crs, f.string());
    unit = io::height_unit_of(f);
  }
  std::vector<double> heights(const std::vector<Vector2d>& at) const {
    Vector2d low = at.front(), high = low;
    for (const Vector2d& p : at) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const double c = lattice.cell;
    const core::Lattice l = core::lattice_of(c, low.x() - c, low.y() - c, high.x() + c, high.y() + c);
    const bool meets = l.west() < lattice.east() && l.east() > lattice.west() && l.south() < lattice.north() && l.north() > lattice.south();
    std::vector<double> out(at.size(), none);
    if (!meets) return out;
    const core::Grid grid = read_surface(file, l).grid;
    for (size_t k = 0; k < at.size(); ++k) out[k] = report::sample(grid, at[k].x(), at[k].y()).height;
    return out;
  }
};

struct Station {
  double station = 0.0;
  Vector2d at, along;
};

std::vector<Station> stations_of(const ProfileLine& line, double step) {
  std::vector<Station> out;
  Station end{0.0, Vector2d::Zero(), Vector2d::Zero()};
  double begin = 0.0, next = 0.0;
  for (size_t k = 1; k < line.vertices.size(); ++k) {
    const Vector2d d = line.vertices[k] - line.vertices[k - 1];
    const double length = d.norm();
    if (!(length > 0.0)) continue;
    for (; next <= begin + length; next = static_cast<double>(out.size()) * step)
      out.push_back({next, line.vertices[k - 1] + d * ((next - begin) / length), d / length});
    begin += length;
    end = {begin, line.vertices[k], d / length};
  }
  if (!out.empty() && end.station - out.back().station > 1e-6 * step) out.push_back(end);
  return out;
}

/// One section; areas in units of the map times units of height.
struct Section {
  double ground = none, design = none, cut = 0.0, fill = 0.0, known = 0.0;
};

std::string number(double v) {
  if (!std::isfinite(v)) return {};
  char text[40];
  std::snprintf(text, sizeof text, "%.3f", v);
  return text;
}

class Writer {
 public:
  Writer(const CrossSectionRequest& r) : request_(r), terrain_(r.axis.dtm) {
    if (!r.design.empty()) {
      design_.emplace(r.design);
      if (!core::are_comparable(terrain_.crs, design_->crs))
        throw core::Error("terrain and design are in different CRSs: " + terrain_.crs.name() + " and " + design_->crs.name(),
                          r.design.string(), "bring one to the other's CRS and vertical datum first");
      if (terrain_.unit != design_->unit)
        throw core::Error("terrain and design have heights in different units", r.design.string(), "bring one to the other's unit first");
    }
    metre_ = terrain_.crs.empty() ? 1.0 : terrain_.crs.metres_per_unit();
    if (metre_ == 0.0) throw core::Error("the terrain model is in degrees", r.axis.dtm.string(), "sections need a projected CRS");
    vertical_ = terrain_.crs.empty() ? 1.0 : terrain_.unit;
  }

  std::vector<AxisSections> run() {
    std::vector<AxisSections> out;
    for (const ProfileLine& line : profile_lines(request_.axis, terrain_.crs)) out.push_back(along(line));
    if (met_ == 0)
      throw core::Error("no section meets the terrain model", request_.axis.dtm.string(), "check the CRS of the axis, and its place");
    io::write_text_file(request_.axis.folder / sections_name, rows_);
    io::write_text_file(request_.axis.folder / section_points_name, points_);
    return out;
  }

 private:
  AxisSections along(const ProfileLine& line) {
    AxisSections sum{line.name};
    std::optional<std::pair<double, Section>> before;
    for (const Station& s : stations_of(line, request_.step / metre_)) {
      const Section now = across(line.name, s);
      const double run = before ? (s.station - before->first) * metre_ : 0.0, area = metre_ * vertical_;
      const double cut = before ? 0.5 * (now.cut + before->second.cut) * area * run : 0.0;
      const double fill = before ? 0.5 * (now.fill + before->second.fill) * area * run : 0.0;
      sum.cut += cut, sum.fill += fill, sum.length += run;
      ++sum.sections;
      sum.incomplete += now.known < 1.0;
      before = {s.station, now};
      rows_ += core::csv_field(line.name) + "," + number(s.station) + "," + number(s.at.x()) + "," + number(s.at.y()) + "," +
               number(std::fmod(std::atan2(s.along.x(), s.along.y()) * 180.0 / M_PI + 360.0, 360.0)) + "," + number(now.ground) + "," +
               number(now.design) + "," + number(now.cut * area) + "," + number(now.fill * area) + "," + number(cut) + "," + number(fill) +
               "," + number(now.known) + "\n";
    }
    return sum;
  }

  Section across(const std::string& name, const Station& s) {
    const double half = 0.5 * request_.width / metre_;
    const int n = std::max(1, static_cast<int>(std::ceil(half / (0.5 * terrain_.lattice.cell))));
    const Vector2d right(s.along.y(), -s.along.x());
    std::vector<Vector2d> at;
    for (int k = -n; k <= n; ++k) at.push_back(s.at + right * (half * k / n));
    const std::vector<double> ground = terrain_.heights(at);
    const bool compares = design_ || request_.level;
    const std::vector<double> design = design_ ? design_->heights(at) : std::vector<double>(at.size(), request_.level.value_or(none));
    Section out;
    out.ground = ground[static_cast<size_t>(n)], out.design = design[static_cast<size_t>(n)];
    size_t known = 0;
    const auto is_known = [&](size_t k) { return std::isfinite(ground[k]) && (!compares || std::isfinite(design[k])); };
    for (size_t k = 0; k < at.size(); ++k) {
      met_ += std::isfinite(ground[k]);
      const double offset = half * (static_cast<double>(k) - n) / n;
      points_ += core::csv_field(name) + "," + number(s.station) + "," + number(offset) + "," + number(at[k].x()) + "," +
                 number(at[k].y()) + "," + number(ground[k]) + "," + number(design[k]) + "\n";
      if (k == 0 || !is_known(k) || !is_known(k - 1)) continue;
      ++known;
      if (compares) add(ground[k - 1] - design[k - 1], ground[k] - design[k], half / n, out);
    }
    out.known = static_cast<double>(known) / static_cast<double>(2 * n);
    return out;
  }

  /// The strip between two places, the difference linear between them.
  static void add(double a, double b, double run, Section& s) {
    const double cross = a * b < 0.0 ? a / (a - b) : 1.0;
    for (const double area : {0.5 * a * cross * run, cross < 1.0 ? 0.5 * b * (1.0 - cross) * run : 0.5 * b * run})
      (area > 0.0 ? s.cut : s.fill) += std::abs(area);
  }

  const CrossSectionRequest& request_;
  Model terrain_;
  std::optional<Model> design_;
  double metre_ = 1.0, vertical_ = 1.0;
  size_t met_ = 0;
  std::string rows_ = "axis,station,x,y,bearing_deg,ground,design,cut_area,fill_area,cut_volume,fill_volume,known_share\n";
  std::string points_ = "axis,station,offset,x,y,ground,design\n";
};

}  // namespace

std::vector<AxisSections> write_cross_sections(const CrossSectionRequest& request) {
  if (request.axis.dtm.empty()) throw core::usage_error("sections need a terrain model", "swath profile", "name it by --dtm FILE");
  const InputGuard guard({request.axis.dtm, request.axis.lines, request.design});
  for (const char* name : {sections_name, section_points_name}) guard.expect_apart(request.axis.folder / name);
  return Writer(request).run();
}

}  // namespace swath::pipeline
