// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/flight_plan/plan_input.h"

#include <algorithm>
#include <cmath>

#include "core/area.h"
#include "core/config/option_visitors.h"
#include "core/error.h"
#include "core/geo/map_axes.h"
#include "core/geo/same_map.h"
#include "io/raster/geotiff.h"
#include "io/raster/height_file.h"
#include "io/survey/tree_kind.h"
#include "io/text/value_file.h"
#include "pipeline/jobs/set_options.h"
#include "pipeline/line_file.h"
#include "pipeline/plan.h"

namespace swath::pipeline {
namespace {

using Eigen::Vector2d;
namespace fs = std::filesystem;

/// Swaths reach beyond the area: so many flying heights of the terrain model are read around it.
constexpr double heights_around = 2.0, farthest_around = 20e3;

fs::path beside(const fs::path& config, const fs::path& file) { return file.empty() ? file : config.parent_path() / file; }

planning::PlanOptions options_of(const PlanRequest& request, core::Value& simulation) {
  core::Value given = io::read_value_file(request.config);
  io::require_kind(given, io::TreeKind::flight_plan, request.config);
  for (const std::string& set : request.sets) set_option(given, set);
  if (const core::Value* table = given.find("simulate")) {
    if (!table->is_object()) throw core::usage_error("'simulate' is no table", request.config.string(), "write [simulate]");
    simulation = *table;
  }
  planning::PlanOptions options;
  std::vector<core::Fault> faults;
  core::read_options(core::described(options), given, "", faults, {"simulate"});
  core::throw_if_any(faults);
  options.area = beside(request.config, options.area);
  options.dem = request.dem.empty() ? beside(request.config, options.dem) : request.dem;
  if (options.dem.empty() == !options.ground)
    throw core::usage_error(options.ground ? "a terrain model and level ground are both given" : "no ground is given",
                            request.config.string(), "give a terrain model (dem, or --dem FILE) or the height of level ground (ground)");
  return options;
}

/// The UTM zone of the area's first corner; corners are in metres, also of a map in feet.
std::string utm_of_area(const planning::PlanOptions& o, const core::Crs& crs) {
  if (o.area.empty()) {
    if (o.corners.empty() || !crs.is_projected()) return core::utm_for(crs);
    return core::utm_for(crs, Vector2d(o.corners[0].east.value, o.corners[0].north.value) / crs.metres_per_unit());
  }
  const io::VectorLines area = io::read_lines(o.area);
  const core::Crs own = area.crs_wkt.empty() ? crs : core::Crs(area.crs_wkt).horizontal();
  if (area.lines.empty() || area.lines[0].x.empty()) return core::utm_for(own);
  return core::utm_for(own, Vector2d(area.lines[0].x[0], area.lines[0].y[0]));
}

core::Crs crs_of(const planning::PlanOptions& o, const fs::path& config) {
  core::Crs crs;
  const auto take = [&crs](const std::string& definition) {
    if (crs.empty() && !definition.empty()) crs = core::Crs(definition).horizontal();
  };
  take(o.crs);
  if (!o.dem.empty()) take(io::read_raster_info(o.dem).crs_wkt);
  if (!o.area.empty()) take(io::read_lines(o.area).crs_wkt);
  if (crs.empty()) throw core::usage_error("the CRS is not known", config.string(), "state it: crs = \"EPSG:25832\"");
  core::require_easting_northing(crs, config.string());
  if (!crs.is_projected() || crs.metres_per_unit() != 1.0)
    throw core::usage_error("a plan needs a projected CRS in metres, " + crs.name() + " is not one", config.string(),
                            "state the UTM zone as crs: " + utm_of_area(o, crs) +
                                ". A file of the area is transformed; corners and a terrain model (gdalwarp -t_srs) must be in it");
  return crs;
}

core::Box box_of(const std::vector<planning::Ring>& area) {
  core::Box b{area[0][0].x(), area[0][0].y(), area[0][0].x(), area[0][0].y()};
  for (const planning::Ring& r : area)
    for (const Vector2d& p : r) b = {std::min(b.x0, p.x()), std::min(b.y0, p.y()), std::max(b.x1, p.x()), std::max(b.y1, p.y())};
  return b;
}

core::HeightField ground_of(const planning::PlanOptions& o, const core::Crs& crs, const core::Box& box) {
  if (o.ground) return core::HeightField(o.ground->value);
  const double height = o.flight.height ? o.flight.height->value : 2000.0;
  io::HeightFile dem = io::read_heights(o.dem, box.grown(std::min(farthest_around, heights_around * height + o.flight.margin.value)));
  if (!dem.crs.empty() && !core::is_same_map(dem.crs, crs))
    throw core::usage_error("the terrain model is in " + dem.crs.horizontal().name() + ", the plan in " + crs.name(), o.dem.string(),
                            "leave `crs` out, or warp the model (gdalwarp -t_srs)");
  return std::move(dem.field);
}

double mean_of(const core::HeightField& ground, const std::vector<planning::Ring>& area, const core::Box& box) {
  constexpr int steps = 100;
  double sum = 0.0;
  int n = 0;
  for (int j = 0; j < steps; ++j)
    for (int i = 0; i < steps; ++i) {
      const Vector2d p(box.x0 + (box.x1 - box.x0) * (i + 0.5) / steps, box.y0 + (box.y1 - box.y0) * (j + 0.5) / steps);
      if (!planning::inside(area, p)) continue;
      sum += ground.height(p.x(), p.y());
      ++n;
    }
  return n > 0 ? sum / n : ground.height(0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1));
}

}  // namespace

PlanInput read_plan_input(const PlanRequest& request) {
  PlanInput in;
  in.options = options_of(request, in.simulation);
  in.crs = crs_of(in.options, request.config);
  in.options.crs = in.crs.epsg() != 0 ? "EPSG:" + std::to_string(in.crs.epsg()) : in.crs.wkt();
  if (in.options.area.empty()) {
    in.area.emplace_back();
    for (const planning::CornerOptions& c : in.options.corners) in.area[0].emplace_back(c.east.value, c.north.value);
  } else {
    std::uint64_t left_out = 0;
    in.area = read_rings_in(in.options.area, in.crs, left_out);
    if (left_out > 0)
      throw core::Error(core::counted(left_out, "vertex of the area is", "vertices of the area are") + " not finite or beyond every map",
                        in.options.area.string(), "is the CRS of the file right?");
  }
  const core::Box box = box_of(in.area);
  in.ground = ground_of(in.options, in.crs, box);
  in.mean_ground = mean_of(in.ground, in.area, box);
  return in;
}

}  // namespace swath::pipeline
