// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/measures/map_terrain_files.h"

#include <algorithm>
#include <cstdio>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "io/raster/geotiff.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "pipeline/input_guard.h"
#include "pipeline/line_file.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

struct MapFile {
  fs::path name;
  io::VectorLines lines;
  io::SpotFile spots;
};

std::vector<MapFile> read_files(const MapTerrainRequest& r) {
  std::vector<MapFile> out;
  for (const fs::path& file : r.files) out.push_back({file, io::read_lines(file, r.field), io::read_spots(file, r.field)});
  return out;
}

core::Crs crs_of(const MapTerrainRequest& r, const std::vector<MapFile>& files) {
  if (!r.crs.empty()) return core::Crs(r.crs);
  for (const MapFile& file : files)
    if (!file.spots.crs_wkt.empty()) return core::Crs(file.spots.crs_wkt);
  return {};
}

bool is_place(double x, double y, double z) { return is_on_a_map(x, y) && std::isfinite(z); }

/// The line with its heights; nothing where it has none, or no length.
std::optional<terrain::MapLine> map_line(const io::VectorLine& line, const std::string& place) {
  const bool has_z = !line.z.empty();
  const bool changes = has_z && *std::max_element(line.z.begin(), line.z.end()) > *std::min_element(line.z.begin(), line.z.end());
  if (!changes && !std::isfinite(line.height)) return std::nullopt;
  terrain::MapLine out{{}, !changes, place};
  for (size_t k = 0; k < line.x.size(); ++k) {
    const double z = changes ? line.z[k] : line.height;
    if (is_place(line.x[k], line.y[k], z)) out.vertices.emplace_back(line.x[k], line.y[k], z);
  }
  if (out.vertices.size() < 2) return std::nullopt;
  return out;
}

terrain::MapContent content_of(std::vector<MapFile> files, const core::Crs& crs, MapTerrainFound& found) {
  terrain::MapContent out;
  for (MapFile& file : files) {
    size_t number = 0;
    move_into(crs, file.name, file.lines);
    for (const io::VectorLine& line : file.lines.lines) {
      auto one = map_line(line, file.name.string() + ": layer " + line.layer + ", line " + std::to_string(++number));
      if (!one) {
        ++found.without_height;
        continue;
      }
      ++(one->contour ? found.contours : found.breaklines);
      out.lines.push_back(std::move(*one));
    }
    move_into(crs, file.name, file.spots);
    const io::SpotFile& spots = file.spots;
    found.without_height += spots.without_height;
    for (size_t k = 0; k < spots.x.size(); ++k)
      if (is_place(spots.x[k], spots.y[k], spots.z[k])) out.spots.emplace_back(spots.x[k], spots.y[k], spots.z[k]);
  }
  found.spots = out.spots.size();
  return out;
}

void write_products(const MapTerrainRequest& r, const core::Crs& crs, const terrain::MapSurface& s, const MapTerrainFound& found) {
  std::error_code ec;
  fs::create_directories(r.folder, ec);
  if (ec) throw core::SystemError("cannot make the folder: " + ec.message(), r.folder.string());
  const std::string wkt = crs.empty() ? std::string() : crs.wkt();
  io::write_grid(r.folder / "dtm.tif", s.grid, wkt);
  io::write_grid(r.folder / "dtm_quality.tif", s.grid, wkt, {false, !s.grid.sigma.empty(), false, true});
  std::vector<float> part;
  for (const terrain::MapPart p : s.part) part.push_back(static_cast<float>(p));
  io::write_raster(r.folder / "dtm_part.tif", s.grid.lattice, {{"1 between contours, 2 flat and filled, 3 flat and kept", "", &part}}, wkt,
                   false);
  io::write_text_file(r.folder / "map_terrain.json", io::to_json(core::reported(found)));
}

}  // namespace

MapTerrainFound write_map_terrain(const MapTerrainRequest& r) {
  const InputGuard guard(r.files);
  for (const char* name : {"dtm.tif", "dtm_quality.tif", "dtm_part.tif", "map_terrain.json"}) guard.expect_apart(r.folder / name);
  std::vector<MapFile> files = read_files(r);
  const core::Crs crs = crs_of(r, files);
  const double metre = crs.empty() ? 1.0 : crs.metres_per_unit(), vertical = crs.empty() ? 1.0 : crs.vertical_metres_per_unit();
  if (metre == 0.0)
    throw core::Error("the map is in degrees", r.files.front().string(), "name a projected CRS for the model: --crs EPSG:25832");
  MapTerrainFound found;
  const terrain::MapContent content = content_of(std::move(files), crs, found);
  const auto heights = [&](std::optional<double> v) { return v ? std::optional(*v / vertical) : v; };
  terrain::MapTerrain made = terrain::map_terrain(
      content, {r.cell / metre, heights(r.interval), heights(r.sigma), r.max_edge / metre, r.tolerance / vertical, r.keep_flats});
  found.levels = made.levels, found.interval = made.interval * vertical, found.cell = r.cell;
  found.voids = static_cast<size_t>(std::count(made.surface.part.begin(), made.surface.part.end(), terrain::MapPart::none));
  found.cells = made.surface.part.size() - found.voids;
  found.flat_parts = made.surface.flats.parts, found.flat_parts_left = made.surface.flats.parts_left;
  for (terrain::MapError& e : made.errors) {
    e.every_second *= vertical, e.every_fourth *= vertical;
    if (e.sigma) *e.sigma *= vertical;
  }
  found.errors = std::move(made.errors);
  write_products(r, crs, made.surface, found);
  return found;
}

std::string map_terrain_text(const MapTerrainFound& f) {
  char line[240];
  std::snprintf(line, sizeof line, "%s of %s, interval %g; %s, %s; without a height: %llu\n", core::counted(f.contours, "contour").c_str(),
                core::counted(f.levels, "height").c_str(), f.interval, core::counted(f.spots, "spot height").c_str(),
                core::counted(f.breaklines, "breakline").c_str(), static_cast<unsigned long long>(f.without_height));
  std::string out = line;
  std::snprintf(line, sizeof line, "%zu cells of %g, %zu void; flat parts filled: %zu, left flat: %zu\n", f.cells, f.cell, f.voids,
                f.flat_parts, f.flat_parts_left);
  out += line;
  std::snprintf(line, sizeof line, "%-18s %12s %12s %14s %14s %10s\n", "part", "cells", "tested", "every second", "every fourth", "sigma");
  out += line;
  for (const terrain::MapError& e : f.errors) {
    if (e.cells == 0) continue;
    std::snprintf(line, sizeof line, "%-18s %12zu %12zu %14.3f %14.3f %10.3f%s\n", e.part.c_str(), e.cells, e.tested, e.every_second,
                  e.every_fourth, e.sigma.value_or(std::nan("")), e.assumed ? " (assumed)" : "");
    out += line;
  }
  return out;
}

}  // namespace swath::pipeline
