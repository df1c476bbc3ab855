// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/cloud/las_product.h"

#include <algorithm>
#include <cmath>

#include "core/geo/height_unit.h"
#include "io/las/las_crs.h"
#include "io/las/las_writer.h"
#include "stages/adapters/cloud/clouds.h"
#include "stages/adapters/units.h"

namespace swath::stages {
namespace {

constexpr double finest_default = 0.001;

/// Near the data, and the same for every tile: tiles can be joined without rounding again.
Eigen::Vector3d offset_near(const Context& context) {
  return {std::round(context.origin.x() / context.unit), std::round(context.origin.y() / context.unit), 0.0};
}

template <class H>
void date_file(const Context& context, H& header) {
  header.guid = context.project;
  header.creation_year = static_cast<std::uint16_t>(context.creation_year);
  header.creation_day = static_cast<std::uint16_t>(context.creation_day);
}

/// The files of the run's clouds, and the header of every tile.
struct LasRun {
  std::shared_ptr<const io::LasSources> sources;
  io::LasHeader header;
  std::vector<std::string> left_out;
};

/// Of those that COPC has, the one with the fields of the given format but for waveforms.
int copc_format(int format) {
  constexpr std::array<int, 11> like{6, 6, 7, 7, 6, 7, 6, 7, 8, 6, 8};
  return like[static_cast<std::size_t>(format)];
}

/// The one with colours and all fields of the given format.
int coloured_format(int format) {
  constexpr std::array<int, 11> like{2, 3, 2, 3, 5, 5, 7, 7, 8, 10, 10};
  return like[static_cast<std::size_t>(format)];
}

/// `coloured`: the points have colours, of their files or of a stage of the run.
LasRun las_run(const Context& context, const PointFields& fields, bool coloured) {
  std::vector<io::LasSource> files = io::cloud_sources(context.survey, cloud_map(context));
  const auto all_of = [&](const auto& is) { return std::all_of(files.begin(), files.end(), is); };
  const bool same_places = all_of([](const io::LasSource& s) { return s.same_places; });
  const bool same_steps =
      all_of([&](const io::LasSource& s) { return s.header.offset == files[0].header.offset && s.header.scale == files[0].header.scale; });
  const bool all_extended = all_of([](const io::LasSource& s) { return s.header.point_format >= 6; });
  const bool all_wkt = all_of([](const io::LasSource& s) { return (s.header.global_encoding & io::las_encoding::wkt) != 0; });
  // A file that leaves the unit of its heights open is read in that of its horizontal axes.
  const bool says_heights = context.crs.has_height_unit() || core::is_same_unit(context.vertical_unit, context.unit) ||
                            all_of([](const io::LasSource& s) { return io::las_crs(s.header).vertical_metres > 0.0; });
  const bool keeps = says_heights && io::keeps_crs(files, context.crs) && (all_wkt || !fields.only_copc);
  auto all = std::make_shared<const io::LasSources>(std::move(files), fields.times == WrittenTimes::recorded);
  const int common = all->header(false).point_format;
  std::optional<int> format = fields.point_format;
  if (!format && coloured && coloured_format(common) != common) format = coloured_format(common);
  if (fields.only_copc && !fields.point_format) format = copc_format(format.value_or(common));
  const bool keep_crs = keeps && (all_extended || format.value_or(common) < 6);
  LasRun run{all, all->header(keep_crs), all->left_out()};
  io::LasHeader& header = run.header;
  if (!all->same_project()) date_file(context, header);
  if (fields.scale || !same_places) header.scale = Eigen::Vector3d::Constant(fields.scale.value_or(finest_default));
  if (fields.scale || !same_places || !same_steps) header.offset = offset_near(context);
  if (fields.only_copc) {
    constexpr auto waves = static_cast<unsigned>(io::las_encoding::waveform_internal | io::las_encoding::waveform_external);
    header.global_encoding = static_cast<std::uint16_t>(header.global_encoding & ~waves);
    const auto is_wave = [](const io::LasVlr& v) {
      return v.user_id == "LASF_Spec" && ((v.record_id >= 100 && v.record_id < 355) || v.record_id == 65535);
    };
    std::erase_if(header.vlrs, is_wave);
    std::erase_if(header.evlrs, is_wave);
    if (io::las_layout(common)->wave) run.left_out.push_back("waveforms: COPC has no point format for them");
  }
  if (format) header.point_format = *format;
  if (!keep_crs) io::add_las_wkt(header, core::Crs(context.product_crs).wkt1());
  if (!keep_crs || format) header.version_minor = 4;
  return run;
}

}  // namespace

core::ColumnSet all_columns() {
  core::ColumnSet all;
  for (int c = 0; c < core::column_count; ++c) all.add(static_cast<core::Column>(c));
  return all;
}

io::TileFacts write_points(TileJob& job, const Context& context, const PointFields& fields, RunCache& cache,
                           const std::filesystem::path& file) {
  io::LasWriteOptions o;
  o.format = fields.point_format;
  o.scale = Eigen::Vector3d::Constant(fields.scale.value_or(finest_default));
  o.offset = offset_near(context);
  o.crs_wkt = core::Crs(context.product_crs).wkt1();
  o.times_as_they_are = context.weekless;
  date_file(context, o);
  o.threads = 1;
  std::optional<io::LasWriter> writer;
  const auto open = [&](const core::Block& first) {
    if (!first.source.empty()) {
      const LasRun& run = cache.get([&] { return las_run(context, fields, !first.red.empty()); });
      o.sources = run.sources, o.header = run.header;
    }
    writer.emplace(file, o);
  };
  // Fields hang on all of the points, so that these are gone through twice.
  job.stream([&](core::Block& block) {
    if (!writer) open(block);
    writer->look_at(block);
  });
  if (!writer) open({});
  io::TileFactsOf facts;
  bool has_colours = false;
  job.stream([&](core::Block& block) {
    has_colours = has_colours || !block.red.empty();
    if (o.sources) o.sources->complete(block);
    facts.add(block);
    to_crs_units(context, block);
    writer->write(block);
  });
  if (fields.point_format && !io::las_layout(*fields.point_format)->rgb && has_colours)
    job.tally.count("colours that the point format cannot hold (point_format = 7 keeps them)", facts.facts().points);
  if (writer->overlap_lost() > 0)
    job.tally.count("overlap flags that the point format cannot hold (point_format = 6 keeps them)", writer->overlap_lost());
  writer->finish();
  return facts.facts();
}

void count_not_carried(RunCache& cache, core::Tally& tally) {
  if (const LasRun* run = cache.find<LasRun>())
    for (const std::string& what : run->left_out) tally.count("not carried from the cloud's files", what);
}

}  // namespace swath::stages
