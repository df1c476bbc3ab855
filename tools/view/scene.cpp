// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/view/scene.h"

#include <cmath>

#include "core/error.h"
#include "core/geo/height_unit.h"
#include "core/geo/map_axes.h"
#include "io/raster/geotiff.h"
#include "io/text/value_file.h"
#include "pipeline/provenance.h"
#include "pipeline/summary.h"
#include "report/html.h"

namespace swath::tools {
namespace {

namespace fs = std::filesystem;
using core::Value;

constexpr double metres_per_degree = 111319.49;  // along the equator of WGS84

/// Name and units of the CRS, and metres in one unit east, north and up (degrees: in the middle of the data).
Value crs_table(const core::Crs& crs, double north) {
  Value out = Value::object();
  double east_m = 1.0, north_m = 1.0, up_m = 1.0;
  out["name"] = crs.empty() ? std::string("no coordinate reference system is stated") : crs.name();
  out["unit"] = crs.empty() ? std::string() : crs.is_geographic() ? std::string("deg") : core::unit_symbol(crs.metres_per_unit());
  // As everywhere in LAS, heights without a stated unit are in that of the plane.
  const bool in_metres = !crs.empty() && crs.is_geographic() && !crs.has_height_unit();
  out["heightUnit"] = crs.empty() ? std::string()
                      : in_metres ? std::string("m")
                                  : core::unit_symbol(crs.has_height_unit() ? crs.vertical_metres_per_unit() : crs.metres_per_unit());
  if (!crs.empty() && crs.is_geographic()) {
    north_m = metres_per_degree;
    east_m = metres_per_degree * std::cos(north * 3.14159265358979323846 / 180.0);
  } else if (!crs.empty() && crs.metres_per_unit() > 0.0) {
    east_m = north_m = crs.metres_per_unit();
  }
  if (!crs.empty() && crs.has_height_unit())
    up_m = crs.vertical_metres_per_unit();
  else if (!crs.empty() && !crs.is_geographic())
    up_m = east_m;
  out["toMetres"] = Value(Value::Array{east_m, north_m, up_m});
  return out;
}

/// Where there are no points: the box of the terrain model.
void add_extent(Scene& scene) {
  const Value& t = *scene.table.find("terrain");
  const double west = t.find("west")->as_number(), south = t.find("south")->as_number(), cell = t.find("cell")->as_number();
  const double base = t.find("base")->as_number();
  Value about = Value::object();
  about["scale"] = Value(Value::Array{0.001, 0.001, 0.001});
  about["offset"] = Value(Value::Array{west, south, base});
  about["low"] = Value(Value::Array{west, south, base});
  about["high"] = Value(Value::Array{west + cell * t.find("nx")->as_number(), south + cell * t.find("ny")->as_number(), base});
  scene.table["extent"] = about;
}

std::string definition_in(const Value& report) {
  const Value* crs = report.find("crs");
  const Value* text = crs ? crs->find("definition") : nullptr;
  return text && text->is_text() ? text->as_text() : std::string();
}

std::string text_at(const Value& table, std::string_view key) {
  const Value* v = table.find(key);
  return v && v->is_text() ? v->as_text() : std::string();
}

/// The CRS of what is shown; points are not read where the page cannot show it.
core::Crs require_map(const std::string& definition, const fs::path& file) {
  core::Crs crs = definition.empty() ? core::Crs() : core::Crs(definition);
  if (!crs.empty() && crs.is_geocentric())
    throw core::Error("coordinates are geocentric (" + crs.name() + "), and a page shows a map", file.string(),
                      "bring them to a CRS of the map first: swath run configs/cloud.toml, and view its output");
  core::require_easting_northing(crs, file.string());
  return crs;
}

}  // namespace

void add_report(Scene& scene, const ProductFiles& files, const std::vector<std::string>& notes) {
  const auto paragraph = [](const std::string& text) { return "<p>" + report::escaped(text) + "</p>\n"; };
  std::string& out = scene.report;
  if (!files.report.empty()) {
    const Value run = io::read_value_file(files.report);
    out += "<h2>Run</h2>\n" + paragraph(text_at(run, "program")) + "<pre>" + report::escaped(text_at(run, "command")) + "</pre>\n";
    if (const Value* warnings = run.find("warnings"); warnings && warnings->is_array() && !warnings->items().empty()) {
      out += "<h2>Warnings</h2>\n<ul>\n";
      for (const Value& w : warnings->items())
        out += "<li><code>" + report::escaped(text_at(w, "code")) + "</code> " + report::escaped(text_at(w, "text")) + "</li>\n";
      out += "</ul>\n";
    }
    out += "<h2>Figures</h2>\n<pre>" + report::escaped(pipeline::summary(run, files.folder)) + "</pre>\n";
  }
  out +=
      "<h2>This page</h2>\n" + paragraph(scene.about + ". Made by swath " + std::string(pipeline::program_version()) + " from:") + "<ul>\n";
  for (const fs::path& f : files.clouds) out += "<li>" + report::escaped(f.filename().string()) + "</li>\n";
  for (const fs::path& f : {files.terrain, files.contours, files.trajectory})
    if (!f.empty()) out += "<li>" + report::escaped(f.filename().string()) + "</li>\n";
  out += "</ul>\n";
  for (const std::string& note : notes) out += paragraph(note);
}

Scene make_scene(const ProductFiles& files, const SceneOptions& options, const core::OnProgress& progress) {
  Scene scene;
  std::vector<std::string> notes;
  const Value run = files.report.empty() ? Value::object() : io::read_value_file(files.report);
  core::Crs crs;
  if (files.clouds.empty()) {
    crs = require_map(io::read_raster_info(files.terrain).crs_wkt, files.terrain);
  } else {
    CloudSources clouds = open_clouds(files.clouds);
    crs = require_map(clouds.crs.empty() ? definition_in(run) : clouds.crs, files.clouds.front());
    add_points(scene, std::move(clouds), options, progress);
  }
  if (!files.terrain.empty()) add_terrain(scene, files.terrain, options);
  if (files.clouds.empty()) add_extent(scene);
  if (!files.contours.empty()) add_contours(scene, files.contours, options);
  if (!files.trajectory.empty() && !crs.empty()) try {
      add_trajectory(scene, files.trajectory, crs);
    } catch (const core::Error& e) {
      notes.push_back("The trajectory is not shown: " + e.text());
    }
  const Value* box = scene.table.find("points") ? scene.table.find("points") : scene.table.find("extent");
  scene.table["crs"] = crs_table(crs, box->find("low")->items()[1].as_number());
  const std::string survey = text_at(run, "survey");
  const fs::path first = files.folder.empty() ? files.clouds.front() : fs::absolute(files.folder / "").parent_path();
  scene.title = survey.empty() ? first.filename().string() : survey;
  scene.about += (scene.about.empty() ? "" : ", ") + text_at(scene.table["crs"], "name");
  add_report(scene, files, notes);
  return scene;
}

}  // namespace swath::tools
