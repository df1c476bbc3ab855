// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/volume_files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "core/error.h"
#include "core/geo/same_map.h"
#include "io/raster/geotiff.h"
#include "io/raster/height_file.h"
#include "pipeline/line_file.h"
#include "pipeline/surface_file.h"
#include "report/volumes.h"

namespace swath::pipeline {
namespace {

constexpr std::int64_t band_cells = 1 << 22;  // of the surfaces that are held at a time

/// The cells of `l` that the polygon reaches.
core::Lattice around(const core::Lattice& l, const std::vector<report::Ring>& polygon) {
  Eigen::Vector2d low = polygon[0][0], high = low;
  for (const report::Ring& r : polygon)
    for (const Eigen::Vector2d& p : r) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const std::int64_t i0 = std::max(l.i0, core::cell_index(low.x(), l.cell)), j0 = std::max(l.j0, core::cell_index(low.y(), l.cell));
  const std::int64_t i1 = std::min(l.i0 + l.nx, core::cell_index(high.x(), l.cell) + 1),
                     j1 = std::min(l.j0 + l.ny, core::cell_index(high.y(), l.cell) + 1);
  return {l.cell, i0, j0, static_cast<int>(std::max<std::int64_t>(0, i1 - i0)), static_cast<int>(std::max<std::int64_t>(0, j1 - j0))};
}

/// The cells of one size that both lattices have.
core::Lattice meet(const core::Lattice& a, const core::Lattice& b) {
  const std::int64_t i0 = std::max(a.i0, b.i0), j0 = std::max(a.j0, b.j0);
  const std::int64_t i1 = std::min(a.i0 + a.nx, b.i0 + b.nx), j1 = std::min(a.j0 + a.ny, b.j0 + b.ny);
  return {a.cell, i0, j0, static_cast<int>(std::max<std::int64_t>(0, i1 - i0)), static_cast<int>(std::max<std::int64_t>(0, j1 - j0))};
}

/// The smallest lattice of a's cells that holds both.
core::Lattice both(const core::Lattice& a, const core::Lattice& b) {
  return core::lattice_of(a.cell, std::min(a.west(), b.west()), std::min(a.south(), b.south()), std::max(a.east(), b.east()),
                          std::max(a.north(), b.north()));
}

/// A surface on its file's lattice, of which any window can be asked for.
struct Surface {
  std::filesystem::path file;
  core::Lattice lattice;
  core::Crs crs;
  double vertical_unit = 1.0;

  explicit Surface(const std::filesystem::path& f) : file(f) {
    const io::RasterInfo info = io::read_raster_info(f);
    lattice = io::lattice_of(info, f);
    if (!info.crs_wkt.empty()) crs = core::Crs(info.crs_wkt);
    vertical_unit = io::height_unit_of(f);
  }
  /// On the cells of `l`, of any size; asked for from south to north.
  core::Grid on(const core::Lattice& l) {
    if (l.cell == lattice.cell) return read(l);
    const core::Lattice needed = core::lattice_of(lattice.cell, l.west() - lattice.cell, l.south() - lattice.cell, l.east() + lattice.cell,
                                                  l.north() + lattice.cell);
    return report::resampled(read(meet(needed, lattice)), l);
  }
  io::ImpossibleHeights impossible;

 private:
  double counted_to_ = -std::numeric_limits<double>::infinity();  // y: bands overlap
  core::Grid read(const core::Lattice& l) {
    core::Grid out = read_surface(file, l, [&](double, double y, double v) {
                       if (y > counted_to_) impossible.add(v);
                     }).grid;
    counted_to_ = std::max(counted_to_, l.north());
    return out;
  }
};

core::Grid level(const core::Lattice& l, double height) {
  core::Grid g(l);
  std::fill(g.height.begin(), g.height.end(), static_cast<float>(height));
  std::fill(g.reason.begin(), g.reason.end(), core::Void::none);
  g.sigma.assign(l.size(), 0.0f);
  return g;
}

}  // namespace

VolumesFound volumes_of(const VolumeRequest& request) {
  Surface before(request.before);
  std::optional<Surface> after;
  core::Lattice lattice = before.lattice;
  if (!request.design) {
    after.emplace(request.after);
    if (!core::are_comparable(before.crs, after->crs))
      throw core::Error("the two surfaces are in different CRSs: " + before.crs.name() + " and " + after->crs.name(),
                        request.after.string(), "bring one to the other's CRS and vertical datum first");
    if (before.vertical_unit != after->vertical_unit)
      throw core::Error("the two surfaces have heights in different units", request.after.string(), "bring one to the other's unit first");
    const bool finer = after->lattice.cell < lattice.cell;
    lattice = finer ? both(after->lattice, before.lattice) : both(before.lattice, after->lattice);
  }
  const core::Crs& crs = before.crs.empty() && after ? after->crs : before.crs;
  const double metre = crs.empty() ? 1.0 : crs.metres_per_unit(), vertical = crs.empty() ? 1.0 : before.vertical_unit;
  if (metre == 0.0) throw core::Error("the surface is in degrees", request.before.string(), "volumes need a projected CRS");
  std::vector<report::Ring> polygon;
  std::uint64_t vertices_left_out = 0;
  if (!request.polygon.empty()) {
    polygon = read_rings_in(request.polygon, crs, vertices_left_out);
    lattice = around(lattice, polygon);
  }
  report::VolumeSum sum(vertical / metre, request.correlation, polygon);
  const int rows = static_cast<int>(std::max<std::int64_t>(1, band_cells / std::max(1, lattice.nx)));
  for (int j = 0; lattice.nx > 0 && j < lattice.ny; j += rows) {
    const core::Lattice band{lattice.cell, lattice.i0, lattice.j0 + j, lattice.nx, std::min(rows, lattice.ny - j)};
    sum.add(before.on(band), after ? after->on(band) : level(band, *request.design));
  }
  report::Volumes v = sum.result();
  std::vector<std::string> notes;
  for (const Surface* s : {&before, after ? &*after : nullptr})
    if (s && s->impossible.count > 0) notes.push_back(io::sentence_of(s->impossible, s->file));
  if (after && before.crs.empty() != after->crs.empty()) {
    const Surface &without = before.crs.empty() ? before : *after, &with = before.crs.empty() ? *after : before;
    notes.push_back(without.file.filename().string() + " states no CRS: taken to be in that of " + with.file.filename().string() + ", " +
                    with.crs.name());
  }
  if (v.cells == 0)
    throw core::Error("the two surfaces have no cell in common" + std::string(polygon.empty() ? "" : " inside the polygon"),
                      request.before.string(), notes.empty() ? "" : notes.front());

  const double area = metre * metre, volume = area * metre;
  for (double* one : {&v.cut, &v.fill, &v.net, &v.sigma_cut, &v.sigma_fill, &v.sigma_net}) *one *= volume;
  for (double* one : {&v.area, &v.cut_area, &v.fill_area, &v.area_left_out}) *one *= area;
  return {
      request, vertices_left_out, !crs.empty(), lattice.cell * metre, v, before.impossible.count + (after ? after->impossible.count : 0),
      notes};
}

std::string volume_text(const VolumesFound& found) {
  const report::Volumes& v = found.volumes;
  const bool has_sigma = std::isfinite(v.sigma_net);
  std::string out;
  char line[200];
  const auto volume = [&](const char* name, double value, double sigma) {
    if (has_sigma)
      std::snprintf(line, sizeof line, "%-9s %14.2f%s  +- %.2f\n", name, value, found.has_crs ? " m3" : "", sigma);
    else
      std::snprintf(line, sizeof line, "%-9s %14.2f%s  (no sigma known)\n", name, value, found.has_crs ? " m3" : "");
    out += line;
  };
  volume("cut", v.cut, v.sigma_cut);
  volume("fill", v.fill, v.sigma_fill);
  volume("net", v.net, v.sigma_net);
  const char* square = found.has_crs ? " m2" : "";
  std::snprintf(line, sizeof line, "%-9s %14.2f%s in %llu cells; lowered %.2f, raised %.2f\n", "area", v.area, square,
                static_cast<unsigned long long>(v.cells), v.cut_area, v.fill_area);
  out += line;
  std::snprintf(line, sizeof line, "%-9s %14.2f%s in %llu cells where a surface is void\n", "left out", v.area_left_out, square,
                static_cast<unsigned long long>(v.left_out));
  out += line;
  if (found.vertices_left_out > 0)
    out += "polygon: " + core::counted(found.vertices_left_out, "vertex that is", "vertices that are") +
           " not finite or beyond every map, left out\n";
  if (has_sigma) {
    std::snprintf(line, sizeof line, "sigmas: errors of any two cells of a model correlated by %g\n", found.request.correlation);
    out += line;
  }
  return out + note_text(found);
}

std::string note_text(const VolumesFound& found) {
  std::string out;
  for (const std::string& note : found.notes) out += "note: " + note + "\n";
  return out;
}

}  // namespace swath::pipeline
