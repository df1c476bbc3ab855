// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/cloud/crop.h"

#include "core/error.h"
#include "filters/crop.h"
#include "io/vector/map_shapes.h"
#include "stages/tile.h"

namespace swath::stages {

enum class CropPart { inside, outside };

}  // namespace swath::stages

template <>
struct swath::core::Choices<swath::stages::CropPart> {
  static constexpr std::array<std::string_view, 2> names{"inside", "outside"};
};

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
using core::Column;

struct CropOptions {
  std::optional<fs::path> polygons, axis;
  std::optional<core::Metres> buffer{};
  std::string layer{};
  CropPart keep = CropPart::inside;
};

template <class V>
void describe(CropOptions& o, V& v) {
  v.option("polygons", o.polygons, "Areas, any vector file with polygons or closed lines, relative to survey.toml.");
  v.option("axis", o.axis, "Axis of a corridor, any vector file with lines, relative to survey.toml.");
  v.option("buffer", o.buffer, core::above(0.0), "Distance in plan from the axis, to both sides and beyond its ends.");
  v.option("layer", o.layer, "Layer of the files that is used; empty: all layers.");
  v.option("keep", o.keep, "Part that stays in use; the other one is withheld.");
  v.check(o.polygons || o.axis, "polygons or an axis must be given: polygons = \"area.gpkg\"");
  v.check(o.axis.has_value() == o.buffer.has_value(),
          "an axis needs a buffer and a buffer an axis: axis = \"axis.gpkg\", buffer = \"50 m\"");
}

struct CropFindings {
  std::uint64_t shapes = 0;
  double share = 0.0;
};
template <class V>
void describe(const CropFindings& r, V& v) {
  v.result("shapes", r.shapes, "Areas and axes of the files.");
  v.result("kept_share", r.share, core::share().in_summary(), "Points kept, of those that were not withheld before.");
}

/// What a tile leaves: points kept and withheld.
struct CropRow {
  std::uint64_t inside = 0, outside = 0;
};

fs::path row_file(const fs::path& folder, TileKey key) { return piece_file(folder, key, "crop"); }

std::vector<std::vector<filters::CropLine>> shapes_of(const Context& context, const fs::path& file, const std::string& layer,
                                                      io::MapShapeKind kind) {
  std::vector<std::vector<filters::CropLine>> out;
  for (io::MapShape& s : io::read_map_shapes(io::resolve(context.survey, file), layer, context.crs, kind)) {
    for (filters::CropLine& part : s.parts)
      for (Eigen::Vector2d& p : part) p = p * context.unit - context.origin.head<2>();
    out.push_back(std::move(s.parts));
  }
  return out;
}

filters::CropShapes read_shapes(const Context& context, const CropOptions& o) {
  filters::CropShapes s;
  if (o.polygons) s.areas = shapes_of(context, *o.polygons, o.layer, io::MapShapeKind::area);
  if (!o.axis) return s;
  s.buffer = o.buffer.value().value;
  for (auto& parts : shapes_of(context, *o.axis, o.layer, io::MapShapeKind::axis)) s.axes.push_back(std::move(parts.front()));
  return s;
}

filters::CropCounts crop_tile(TileJob& job, const Context& context, const CropOptions& o, RunCache& cache) {
  const filters::CropShapes& shapes = cache.get([&] { return read_shapes(context, o); });
  const filters::CropCounts counts = filters::crop(job.block, job.own, shapes, o.keep == CropPart::outside);
  write_rows(row_file(job.folder, job.key), std::vector<CropRow>{{counts.inside, counts.outside}});
  return counts;
}

CropRow sum_of(const std::vector<fs::path>& files) {
  std::vector<CropRow> rows;
  for (const fs::path& f : files) read_rows(f, rows);
  CropRow sum;
  for (const CropRow& r : rows) sum.inside += r.inside, sum.outside += r.outside;
  return sum;
}

CropFindings judge_crop(const MergeJob& job, const Context& context, const CropOptions& o) {
  std::vector<fs::path> files;
  for (const TileKey key : job.tiles) files.push_back(row_file(job.folder, key));
  const CropRow sum = sum_of(files);
  const fs::path& named = o.polygons ? *o.polygons : *o.axis;
  if (sum.inside == 0 && sum.outside > 0)
    throw core::Error("no point is left: all " + std::to_string(sum.outside) + " are withheld", io::resolve(context.survey, named).string(),
                      "check that the file covers the survey and states its CRS; one without is taken to be in " +
                          (context.crs.empty() ? std::string("the survey's CRS") : context.crs.name()));
  const filters::CropShapes shapes = read_shapes(context, o);
  const double all = static_cast<double>(sum.inside + sum.outside);
  return {shapes.areas.size() + shapes.axes.size(), all > 0.0 ? static_cast<double>(sum.inside) / all : 0.0};
}

/// Unreadable files and bad polygons are an error before any point is read.
void check_shapes(const Context& context, const CropOptions& o) { read_shapes(context, o); }

void join_counts(const Context&, const TileJob& whole, const std::vector<fs::path>& parts) {
  std::vector<fs::path> files;
  for (const fs::path& part : parts) files.push_back(row_file(part, whole.key));
  write_rows(row_file(whole.folder, whole.key), std::vector<CropRow>{sum_of(files)});
}

std::vector<fs::path> shape_files(const io::Survey& survey, const CropOptions& o) {
  std::vector<fs::path> out;
  for (const auto& file : {o.polygons, o.axis})
    if (file) out.push_back(io::resolve(survey, *file));
  return out;
}

}  // namespace

Entry crop_stage() {
  return tile<crop_tile, judge_crop>("filters.crop", "Part of a cloud: points outside of polygons, or far from an axis, are withheld.",
                                     {.columns = {.needs = {Column::flags}, .gives = {Column::flags}},
                                      .check = check_shapes,
                                      .files = shape_files,
                                      .join_parts = join_counts});
}

}  // namespace swath::stages
