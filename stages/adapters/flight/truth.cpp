// SPDX-License-Identifier: GPL-3.0-or-later
// The run against what is known of a simulated survey: every return by its record, the ground labels, the terrain.
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "core/geo/same_map.h"
#include "io/raster/geotiff.h"
#include "io/text/npy.h"
#include "quality/truth_errors.h"
#include "stages/adapters/adapters.h"
#include "stages/tile.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

using core::Column;

struct TruthFindings {
  std::optional<std::string> truth{};
  std::optional<double> rms_3d{};
  std::optional<quality::PointErrors> points{};
  std::optional<quality::LabelErrors> ground{};
  std::optional<std::string> dtm_not_compared{};
  std::optional<quality::TerrainErrors> dtm{};
};

template <class V>
void describe(const TruthFindings& r, V& v) {
  v.result("truth", r.truth, core::plain().in_summary(), "Why nothing was compared.");
  v.result("rms_3d", r.rms_3d, core::metres().in_summary().limited_by("truth_rms"), "3D RMS error of the points.");
  v.table("points", r.points, "Errors of the points.");
  v.table("ground", r.ground, "Errors of the ground labels.");
  v.result("dtm", r.dtm_not_compared, core::plain().in_summary(), "Why the terrain model was not compared.");
  v.table("dtm", r.dtm, "Errors of the terrain model.");
}

/// Rows of the truth are those of the laser records; a tile's points of one strip rise in record.
quality::TruthSums compare_points(const Context& context, const core::Block& block, size_t own) {
  const fs::path file = io::resolve(context.survey, *context.survey.truth.returns);
  const io::NpyHeader header = io::read_npy_header(file);
  io::NpyReader truth(file, {io::field_of(header, "e", file), io::field_of(header, "n", file), io::field_of(header, "h", file),
                             io::field_of(header, "cls", file)});
  constexpr size_t window = 1 << 16;
  std::vector<std::vector<double>> columns;
  std::uint64_t first = 0, rows = 0;
  quality::TruthSums s;
  for (size_t i = 0; i < own; ++i) {
    const std::uint64_t row = block.record[i];
    if (row >= truth.rows())
      throw core::Error("record " + std::to_string(row) + " has no row of truth", file.string(),
                        "truth.returns must have one row per laser record");
    if (row < first || row >= first + rows) {
      first = row;
      rows = std::min<std::uint64_t>(window, truth.rows() - first);
      truth.read(first, rows, columns);
    }
    const size_t k = row - first;
    s.add(block, i, {columns[0][k] * context.unit, columns[1][k] * context.unit, columns[2][k] * context.vertical_unit},
          static_cast<int>(columns[3][k]));
  }
  return s;
}

void compare_terrain(const Context& context, const std::vector<TileKey>& tiles, TruthFindings& found) {
  const fs::path file = io::resolve(context.survey, *context.survey.truth.dtm);
  const In<Product::dtm> terrain{*context.grids};
  const double cell = terrain.cell();
  const io::RasterInfo raster = io::read_raster_info(file);
  if (std::abs(raster.geotransform[1] * context.unit - cell) > 1e-6 * cell) {
    found.dtm_not_compared = "not compared: the truth has another cell";
    return;
  }
  quality::TerrainSums sums;
  for (const TileKey key : tiles) {
    const core::Lattice own = terrain.lattice(context.box_of(key));
    core::Lattice in_truth = own;
    in_truth.cell = cell / context.unit;
    sums.add(terrain.window(own), io::read_grid(file, in_truth), context.vertical_unit);
  }
  found.dtm = sums.errors();
}

/// One map by name, or in its coordinates: a CRS without a code is written with other words by a GeoTIFF.
bool is_one_map(const Context& context, const core::Crs& truth) {
  if (core::is_same_map(truth, context.crs)) return true;
  constexpr double same = 0.01;  // units of the CRS
  const Eigen::Vector3d at(context.origin.x() / context.unit, context.origin.y() / context.unit, 0.0);
  try {
    return (core::Transform(context.crs.horizontal(), truth.horizontal())(at) - at).head<2>().norm() < same;
  } catch (const core::Error&) {  // no way between them
    return false;
  }
}

/// Why coordinates of the truth are not those of the run: a survey that was given another CRS than it was simulated in. The true terrain
/// states the CRS of all of the truth.
std::string other_map(const Context& context) {
  if (!context.survey.truth.dtm) return {};
  const std::string wkt = io::read_raster_info(io::resolve(context.survey, *context.survey.truth.dtm)).crs_wkt;
  if (wkt.empty() || context.crs.empty()) return {};
  const core::Crs truth(wkt);
  if (is_one_map(context, truth) && !core::are_heights_apart(truth, context.crs)) return {};
  return "not compared: the truth is in " + truth.name() + ", the run in " + context.crs.name();
}

fs::path truth_sums(const fs::path& folder, TileKey key) { return piece_file(folder, key, "sums"); }

void sum_errors(const TileJob& job, const Context& context) {
  quality::TruthSums sums;
  if (context.survey.truth.returns) sums = compare_points(context, job.block, job.own);
  write_rows(truth_sums(job.folder, job.key), std::vector{sums});
}
TruthFindings find_errors(const MergeJob& job, const Context& context) {
  TruthFindings found;
  if (!context.survey.truth.returns && !context.survey.truth.dtm) {
    found.truth = "none: the survey names no truth";
    return found;
  }
  if (const std::string why = other_map(context); !why.empty()) {
    found.truth = why;
    return found;
  }
  std::vector<quality::TruthSums> tiles;
  for (const TileKey key : job.tiles) read_rows(truth_sums(job.folder, key), tiles);
  quality::TruthSums all;
  for (const quality::TruthSums& s : tiles) all.add(s);
  found.points = quality::point_errors(all);
  if (found.points) found.rms_3d = found.points->rms_3d;
  found.ground = quality::label_errors(all);
  if (context.survey.truth.dtm && context.grids->has(Product::dtm)) compare_terrain(context, job.tiles, found);
  return found;
}

std::vector<fs::path> truth_files(const io::Survey& survey) {
  std::vector<fs::path> out;
  for (const auto& f : {survey.truth.returns, survey.truth.dtm})
    if (f) out.push_back(io::resolve(survey, *f));
  return out;
}
void expect_one_laser(const Context& context, const NoOptions&) {
  if (context.survey.truth.returns && context.survey.laser.size() > 1)
    throw core::usage_error("report.truth: truth.returns has one row per record of one laser file; the survey names " +
                                std::to_string(context.survey.laser.size()),
                            context.survey.name, "compare one file at a time, or leave truth.returns out");
}

}  // namespace

Entry truth_stage() {
  return tile<sum_errors, find_errors>(
      "report.truth", "Errors against truth, where the survey names it: points, their sigmas, ground labels, terrain.",
      {.columns = {.needs = {Column::record, Column::strip}, .reads = {Column::sigma_h, Column::sigma_v, Column::classification}},
       .check = expect_one_laser,
       .inputs = truth_files});
}

}  // namespace swath::stages
