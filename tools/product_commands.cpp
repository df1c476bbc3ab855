// SPDX-License-Identifier: GPL-3.0-or-later
// From finished terrain models and clouds: volumes, profiles. From a map: its terrain model.
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "pipeline/measures/cross_sections.h"
#include "pipeline/measures/level_curve.h"
#include "pipeline/measures/map_terrain_files.h"
#include "pipeline/profile.h"
#include "pipeline/volume_files.h"
#include "tools/command.h"

namespace swath::tools {
namespace {

struct VolumeArguments {
  pipeline::VolumeRequest request;
  std::string levels;
  bool json = false;
};

int volumes(const VolumeArguments& a) {
  if (!a.levels.empty()) {
    if (!a.request.after.empty() || a.request.design)
      throw core::usage_error("--levels stands alone", "swath volumes", "leave AFTER and --design out");
    const pipeline::LevelCurve curve = pipeline::level_curve(a.request, pipeline::levels_of(a.levels));
    a.json ? print_json(core::reported(curve)) : print(pipeline::level_text(curve));
    return 0;
  }
  if (a.request.after.empty() == !a.request.design)
    throw core::usage_error("volumes need a second surface or a design height", "swath volumes",
                            "give AFTER, --design or --levels, one of them");
  const pipeline::VolumesFound found = pipeline::volumes_of(a.request);
  a.json ? print_json(core::reported(found)) : print(pipeline::volume_text(found));
  return 0;
}

struct MapTerrainArguments {
  pipeline::MapTerrainRequest request;
  std::string cell = "5 m", interval, sigma, height_unit, max_edge = "1000 m", tolerance = "1 cm", flats = "fill";
  bool quiet = false, json = false;
};

double length_of(const std::string& text, const std::string& option, double least) {
  const double v = quantity(core::Dimension::length, text, option, "5 m");
  if (!(v > least)) throw core::usage_error("'" + text + "' is too small", option, "write a length with its unit: \"5 m\"");
  return v;
}

int map_terrain(MapTerrainArguments& a) {
  pipeline::MapTerrainRequest& r = a.request;
  r.cell = length_of(a.cell, "--cell", 0.0);
  r.max_edge = length_of(a.max_edge, "--max-edge", r.cell);
  r.tolerance = length_of(a.tolerance, "--tolerance", -1e-12);
  if (!a.interval.empty()) r.interval = length_of(a.interval, "--interval", 0.0);
  if (!a.sigma.empty()) r.sigma = length_of(a.sigma, "--sigma", -1e-12);
  if (!a.height_unit.empty()) r.height_unit = length_of(a.height_unit, "--height-unit", 0.0);
  r.keep_flats = a.flats == "keep";
  const pipeline::MapTerrainFound found = pipeline::write_map_terrain(r);
  if (a.json)
    print_json(core::reported(found));
  else if (!a.quiet)
    print(pipeline::map_terrain_text(found));
  return 0;
}

struct ProfileArguments {
  pipeline::ProfileRequest request;
  std::string half_width = "1 m", stations, width = "40 m", design;
  bool quiet = false, json = false;
};

double width_of(const std::string& text, const std::string& option) {
  const double v = quantity(core::Dimension::length, text, option, "20 m");
  if (!(v > 0.0)) throw core::usage_error("'" + text + "' is no width", option, "write a length above 0 with its unit: \"20 m\"");
  return v;
}

int cross_sections(const ProfileArguments& a) {
  if (!a.request.points.empty())
    throw core::usage_error("sections across an axis are of surfaces, and points are not read", "swath profile",
                            "leave POINTS out, or --stations for a section along the line");
  pipeline::CrossSectionRequest r;
  r.axis = a.request;
  r.step = width_of(a.stations, "--stations"), r.width = width_of(a.width, "--width");
  char* end = nullptr;
  const double level = std::strtod(a.design.c_str(), &end);
  if (!a.design.empty() && *end == '\0' && std::isfinite(level))
    r.level = level;
  else
    r.design = a.design;
  core::Value list = core::Value::array();
  for (const pipeline::AxisSections& one : pipeline::write_cross_sections(r)) {
    list.push(core::reported(one));
    if (a.json || a.quiet) continue;
    std::printf("%s: %s over %.1f, cut %.2f, fill %.2f; %zu incomplete; sections.csv and section_points.csv in %s\n", one.name.c_str(),
                core::counted(one.sections, "section").c_str(), one.length, one.cut, one.fill, one.incomplete, r.axis.folder.c_str());
  }
  if (a.json) print_json(list);
  return 0;
}

int profile(ProfileArguments& a) {
  if (!a.stations.empty()) return cross_sections(a);
  if (!a.design.empty())
    throw core::usage_error("--design is for sections across an axis", "swath profile", "give --stations \"20 m\", too");
  a.request.half_width = quantity(core::Dimension::length, a.half_width, "--half-width", "2 m");
  if (!(a.request.half_width > 0.0))
    throw core::usage_error("'" + a.half_width + "' is no width", "--half-width", "write a length with its unit: \"2 m\"");
  core::Value list = core::Value::array();
  for (const pipeline::ProfileFound& one : pipeline::write_profiles(a.request)) {
    list.push(core::reported(one));
    if (!one.warning.empty()) std::fprintf(stderr, "swath: warning: %s: %s\n", one.name.c_str(), one.warning.c_str());
    if (a.json || a.quiet) continue;
    std::printf("%s: %.1f long, %s, %s of the terrain model; .csv, .svg and .png in %s\n", one.name.c_str(), one.length,
                core::counted(one.points, "point").c_str(), core::counted(one.terrain_samples, "place").c_str(), a.request.folder.c_str());
    if (one.vertices_left_out > 0)
      std::printf("  %s not finite or beyond every map, left out\n",
                  core::counted(one.vertices_left_out, "of its vertices is", "of its vertices are").c_str());
  }
  if (a.json) print_json(list);
  return 0;
}

}  // namespace

void add_volumes_command(Commands& commands) {
  const auto a = std::make_shared<VolumeArguments>();
  auto* c = commands.add(
      "volumes",
      "Examples\n  swath volumes may/dtm.vrt june/dtm.vrt --polygon pit.gpkg\n  swath volumes out/dtm.vrt --design 412.5 "
      "--json\n  swath volumes out/dtm.vrt --levels 405,420,0.5 --polygon basin.gpkg\n\nCut and fill between two terrain models, or from "
      "one to a design height, with sigma; or area and volume below levels, as a reservoir's curve.",
      [a] { return volumes(*a); });
  c->add_option("BEFORE", a->request.before, "Terrain model, GeoTIFF or VRT; NAME_quality beside it gives sigma")->required();
  c->add_option("AFTER", a->request.after, "The same later; its cells may be others");
  c->add_option("--design", a->request.design, "Height in place of AFTER, in the unit of BEFORE's heights");
  c->add_option("--levels", a->levels, "LOW,HIGH,STEP: area and volume below each level, in the unit of BEFORE's heights");
  c->add_option("--polygon", a->request.polygon, "Polygons or closed lines to count within, in the CRS of BEFORE");
  c->add_option("--correlation", a->request.correlation, "Of the errors of any two cells of a model: 1 one shift for all, 0 noise")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  c->add_flag("--json", a->json, "As JSON");
}

void add_map_terrain_command(Commands& commands) {
  const auto a = std::make_shared<MapTerrainArguments>();
  auto* c =
      commands.add("map-dtm",
                   "Examples\n  swath map-dtm contours.gpkg spots.shp --cell \"5 m\" --output map\n  swath map-dtm sheet.dxf --crs "
                   "EPSG:25832 --sigma \"0.5 m\" --output map\n\nMake a terrain model of a map: contours, spot heights and breaklines, "
                   "without any laser point.",
                   [a] { return map_terrain(*a); });
  c->add_option("MAP", a->request.files, "GeoPackage, Shapefile, DXF, GeoJSON ...: lines and points with heights")->required();
  c->add_option("--field", a->request.field,
                "Field with the height; without it height, elev, elevation, contour or z, or the z of the places");
  c->add_option("--crs", a->request.crs, "CRS of the model, and of files that state none: EPSG:25832");
  c->add_option("--cell", a->cell, "Side of the model's cells")->capture_default_str();
  c->add_option("--interval", a->interval, "Height between contours; without it the usual one");
  c->add_option("--height-unit", a->height_unit, "Unit of the heights of files that do not state it: \"1 us-ft\"");
  c->add_option("--sigma", a->sigma, "Standard deviation of the contours' own heights; without it they count as right");
  c->add_option("--max-edge", a->max_edge, "Longest triangle bridged")->capture_default_str();
  c->add_option("--tolerance", a->tolerance, "By which contours that meet may differ in height")->capture_default_str();
  c->add_option("--flats", a->flats, "Triangles that join a contour with itself: fill by least bending, or keep")
      ->check(CLI::IsMember({"fill", "keep"}))
      ->capture_default_str();
  add_output(*c, a->request.folder, "Folder to write to")->required();
  add_quiet(*c, a->quiet);
  c->add_flag("--json", a->json, "What was found, as JSON");
}

void add_profile_command(Commands& commands) {
  const auto a = std::make_shared<ProfileArguments>();
  auto* c =
      commands.add("profile",
                   "Examples\n  swath profile out/products/points --dtm out/products/dtm.vrt --from 652010,5310020 --to 652340,5310200 "
                   "--output sections\n  swath profile flight.laz --line axis.gpkg --half-width \"2 m\" --output sections\n\nSections "
                   "through points and terrain model along lines, as CSV, SVG and PNG.",
                   [a] { return profile(*a); });
  c->add_option("POINTS", a->request.points, "LAS or LAZ files, or folders of them");
  c->add_option("--dtm", a->request.dtm, "Terrain model, GeoTIFF or VRT");
  c->add_option("--line", a->request.lines, "Lines to cut along: GeoPackage, GeoJSON, DXF ..., or .csv with profile,x,y");
  c->add_option("--from", a->request.from, "x,y where one straight line begins");
  c->add_option("--to", a->request.to, "x,y where it ends");
  c->add_option("--half-width", a->half_width, "Points up to this far from the line are shown")->capture_default_str();
  c->add_option("--stations", a->stations, "Sections across the line every so far, in place of one along it, as tables");
  c->add_option("--width", a->width, "Of a section across")->capture_default_str();
  c->add_option("--design", a->design, "Surface (raster) or height that sections across are compared with: areas, volumes");
  add_output(*c, a->request.folder, "Folder to write to")->required();
  add_quiet(*c, a->quiet);
  c->add_flag("--json", a->json, "What was found, as JSON");
}

}  // namespace swath::tools
