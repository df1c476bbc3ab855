// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/flight_plan/plan_files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/config/result_visitors.h"
#include "core/config/units.h"
#include "core/error.h"
#include "io/raster/geotiff.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "io/vector/line_layer.h"
#include "pipeline/flight_plan/plan_page.h"
#include "pipeline/input_guard.h"
#include "report/html.h"

namespace swath::pipeline {
namespace {

using core::Dimension;
using core::Value;
using Eigen::Vector2d;
namespace fs = std::filesystem;

Value quantity(Dimension d, double si) { return core::format_quantity(d, si); }
Value metres(double v) { return quantity(Dimension::length, std::round(v * 1e3) / 1e3); }

io::LineLayer layer_of(const planning::FlightPlan& plan) {
  io::LineLayer layer{"flight_lines",
                      "Planned flight lines; heights in m, in the height system of the terrain model",
                      {"order", "height", "course", "length", "above_ground_min", "above_ground_mean", "above_ground_max", "time"},
                      {}};
  for (size_t k = 0; k < plan.lines.size(); ++k) {
    const planning::LineFound& l = plan.lines[k];
    layer.lines.push_back({l.line.name,
                           {l.line.from.x(), l.line.to.x()},
                           {l.line.from.y(), l.line.to.y()},
                           {static_cast<double>(k + 1), l.line.level, core::to_degrees(l.line.course()), l.line.length(), l.lowest, l.mean,
                            l.highest, l.seconds}});
  }
  return layer;
}

std::string csv_of(const planning::FlightPlan& plan, const core::Transform& to_geographic) {
  std::string out =
      "line,from_east,from_north,to_east,to_north,height,course,length,from_latitude,from_longitude,to_latitude,to_longitude,"
      "above_ground_min,above_ground_mean,above_ground_max,time\n";
  char row[400];
  for (const planning::LineFound& l : plan.lines) {
    const auto place = [&](const Vector2d& p) { return to_geographic({p.x(), p.y(), l.line.level}); };
    const Eigen::Vector3d a = place(l.line.from), b = place(l.line.to);
    std::snprintf(row, sizeof row, "%s,%.2f,%.2f,%.2f,%.2f,%.1f,%.2f,%.1f,%.8f,%.8f,%.8f,%.8f,%.1f,%.1f,%.1f,%.1f\n", l.line.name.c_str(),
                  l.line.from.x(), l.line.from.y(), l.line.to.x(), l.line.to.y(), l.line.level, core::to_degrees(l.line.course()),
                  l.line.length(), a.y(), a.x(), b.y(), b.x(), l.lowest, l.mean, l.highest, l.seconds);
    out += row;
  }
  return out;
}

/// Lines and area on the ground: a KML height counts from another level than the plan's, so that it stands in the description.
std::string kml_of(const planning::FlightPlan& plan, const std::vector<planning::Ring>& area, const core::Transform& to_geographic) {
  char text[160];
  const auto coordinates = [&](const std::vector<Vector2d>& places) {
    std::string out;
    for (const Vector2d& p : places) {
      const Eigen::Vector3d g = to_geographic({p.x(), p.y(), 0.0});
      std::snprintf(text, sizeof text, "%.8f,%.8f ", g.x(), g.y());
      out += text;
    }
    return out;
  };
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\">\n<Document>\n<name>" +
                    report::escaped(plan.name) + "</name>\n";
  for (std::vector<Vector2d> ring : area) {
    ring.push_back(ring.front());
    out += "<Placemark><name>area</name><LineString><tessellate>1</tessellate><coordinates>" + coordinates(ring) +
           "</coordinates></LineString></Placemark>\n";
  }
  for (const planning::LineFound& l : plan.lines) {
    std::snprintf(text, sizeof text, "height %.1f m, course %.1f deg, %.0f m long", l.line.level, core::to_degrees(l.line.course()),
                  l.line.length());
    const std::string about = text;
    out += "<Placemark><name>" + report::escaped(l.line.name) + "</name><description>" + about +
           "</description><LineString><tessellate>1</tessellate><coordinates>" + coordinates({l.line.from, l.line.to}) +
           "</coordinates></LineString></Placemark>\n";
  }
  return out + "</Document>\n</kml>\n";
}

/// Tables of `over` member by member, everything else as a whole.
void merge(Value& into, const Value& over) {
  for (const auto& [key, value] : over.members()) {
    Value* here = into.find(key);
    if (here && here->is_object() && value.is_object())
      merge(*here, value);
    else
      into[key] = value;
  }
}

void expect_apart(const PlanRequest& request, const PlanInput& input) {
  const InputGuard guard({request.config, input.options.area, input.options.dem});
  for (const char* name :
       {"plan.json", "plan.html", "lines.gpkg", "lines.kml", "lines.csv", "density.tif", "lines_seen.tif", "sigma.tif", "simulate.json"})
    guard.expect_apart(request.folder / name);
}

}  // namespace

Value simulation_of(const planning::FlightPlan& plan, const PlanInput& in) {
  const planning::PlanOptions& o = in.options;
  Vector2d low = plan.lines[0].line.from, high = low;
  Value lines = Value::array();
  double level = 0.0;
  for (const planning::LineFound& l : plan.lines) {
    for (const Vector2d& p : {l.line.from, l.line.to}) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    level += l.line.level / static_cast<double>(plan.lines.size());
    const auto place = [](const Vector2d& p) { return Value(Value::Array{metres(p.x()), metres(p.y())}); };
    lines.push(Value(Value::Object{{"name", l.line.name},
                                   {"from", place(l.line.from)},
                                   {"to", place(l.line.to)},
                                   {"height", metres(l.line.level)},
                                   {"scans", l.line.scans}}));
  }
  const Vector2d middle = 0.5 * (low + high);
  const Eigen::Vector3d g = core::Transform(in.crs, core::wgs84_geodetic())({middle.x(), middle.y(), in.mean_ground});
  const double reach = (high - low).maxCoeff() + 2 * plan.swath.width;
  const auto angle = [](core::Radians a) { return quantity(Dimension::angle, a.value); };
  Value world(Value::Object{{"scene", "flat"}, {"ground", metres(in.mean_ground)}});
  if (o.dem.empty())
    merge(world, Value(Value::Object{{"slope", 0.0}}));
  else
    merge(world, Value(Value::Object{{"dem", fs::absolute(o.dem).lexically_normal().string()}}));
  const core::SensorSigma& s = o.sigma;
  Value out(Value::Object{
      {"name", o.name},
      {"crs", o.crs},
      {"latitude", quantity(Dimension::angle, g.y() * core::degree)},
      {"longitude", quantity(Dimension::angle, g.x() * core::degree)},
      {"world", world},
      {"flight", Value::Object{{"line", lines},
                               {"height", metres(std::clamp(level - in.mean_ground, 20.0, 5000.0))},
                               {"speed", quantity(Dimension::speed, o.flight.speed->value)},
                               {"bank", angle(o.flight.bank)},
                               {"lead", quantity(Dimension::time, std::max(1.0, o.flight.lead.value))}}},
      {"scanner",
       Value::Object{{"pattern", std::string(core::Choices<planning::ScanPattern>::names.at(static_cast<size_t>(o.sensor.pattern)))},
                     {"prf", quantity(Dimension::frequency, o.sensor.prf->value)},
                     {"frequency", quantity(Dimension::frequency, o.sensor.frequency->value)},
                     {"half_angle", angle(*o.sensor.half_angle)},
                     {"divergence", angle(o.sensor.divergence)}}},
      {"noise", Value::Object{{"range", quantity(Dimension::length, s.range.value)},
                              {"scan_angle", angle(s.scan_angle)},
                              {"horizontal", quantity(Dimension::length, o.trajectory_sigma.horizontal.value)},
                              {"vertical", quantity(Dimension::length, o.trajectory_sigma.vertical.value)},
                              {"roll_pitch", angle(o.trajectory_sigma.roll_pitch)},
                              {"heading", angle(o.trajectory_sigma.heading)}}},
      {"mounting", Value::Object{{"sigma", Value::Object{{"roll", angle(s.roll)},
                                                         {"pitch", angle(s.pitch)},
                                                         {"heading", angle(s.heading)},
                                                         {"lever_arm", quantity(Dimension::length, s.lever_arm.value)},
                                                         {"range_offset", quantity(Dimension::length, s.range_offset.value)},
                                                         {"range_scale", s.range_scale},
                                                         {"scan_offset", angle(s.scan_offset)},
                                                         {"scan_scale", s.scan_scale},
                                                         {"latency", quantity(Dimension::time, s.latency.value)}}}}},
      {"output", Value::Object{{"dtm_cell", metres(std::clamp(std::ceil(reach / 1000.0), 1.0, 100.0))}}}});
  if (in.simulation.is_object()) merge(out, in.simulation);
  return out;
}

bool is_flight_plan(const fs::path& config) {
  if (!fs::is_regular_file(config)) return false;
  const Value given = io::read_value_file(config);
  return given.find("flight") != nullptr && given.find("sensor") != nullptr && given.find("stage") == nullptr;
}

bool is_pipeline(const fs::path& config) { return fs::is_regular_file(config) && io::read_value_file(config).find("stage") != nullptr; }

planning::FlightPlan check_flight_plan(const PlanRequest& request) {
  const PlanInput input = read_plan_input(request);
  return planning::make_flight_plan(input.options, input.area, input.ground);
}

planning::FlightPlan write_flight_plan(const PlanRequest& request) {
  const PlanInput input = read_plan_input(request);
  expect_apart(request, input);
  planning::FlightPlan plan = planning::make_flight_plan(input.options, input.area, input.ground);
  std::error_code ec;
  fs::create_directories(request.folder, ec);
  if (ec) throw core::SystemError("cannot make the folder: " + ec.message(), request.folder.string());
  const core::Transform to_geographic(input.crs, core::Crs("EPSG:4326"));
  const planning::Coverage& c = plan.coverage;
  const std::string& crs = input.options.crs;
  io::write_raster(request.folder / "density.tif", c.lattice, {{"pulses per m2", "", &c.density}}, crs, true);
  io::write_raster(request.folder / "lines_seen.tif", c.lattice, {{"lines", "", &c.lines}}, crs, true);
  io::write_raster(request.folder / "sigma.tif", c.lattice, {{"height", "m", &c.sigma_height}, {"horizontal", "m", &c.sigma_horizontal}},
                   crs, true);
  io::write_line_layer(request.folder / "lines.gpkg", layer_of(plan), crs);
  io::write_text_file(request.folder / "lines.csv", csv_of(plan, to_geographic));
  io::write_text_file(request.folder / "lines.kml", kml_of(plan, input.area, to_geographic));
  io::write_text_file(request.folder / "simulate.json", io::to_json(simulation_of(plan, input)));
  io::write_text_file(request.folder / "plan.html", plan_page(plan, input));
  io::write_text_file(request.folder / "plan.json", io::to_json(core::reported(plan)));
  return plan;
}

std::string plan_text(const planning::FlightPlan& p) {
  char line[300];
  std::string out;
  const auto add = [&](const char* format, auto... values) {
    std::snprintf(line, sizeof line, format, values...);
    out += line;
  };
  add("%s, %.1f km, %.0f min with turns; %s, %.2f h, %.0f %s\n", core::counted(p.lines.size(), "line").c_str(), 1e-3 * p.line_length,
      p.seconds / 60.0, core::counted(p.cost.sorties, "sortie").c_str(), p.cost.hours, p.cost.total, p.cost.currency.c_str());
  add("swath %.0f m from %.0f m above the ground, footprint %.2f m\n", p.swath.width, p.swath.height, p.swath.footprint);
  if (p.least_overlap) add("overlap at least %.1f %%\n", 100.0 * *p.least_overlap);
  add("pulses per m2: %.2f to %.2f (5 to 95 %% of the cells), median %.2f\n", p.density.low, p.density.high, p.density.median);
  add("sigma of the ground's height by one point: %.3f to %.3f m (5 to 95 %%)\n", p.sigma_height.low, p.sigma_height.high);
  if (p.eye_safety) add("eyes are safe from %.0f m on (binoculars: %.0f m)\n", p.eye_safety->height, p.eye_safety->with_binoculars);
  for (const std::string& w : p.warnings) out += "warning: " + w + "\n";
  return out;
}

}  // namespace swath::pipeline
