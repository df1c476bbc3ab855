// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/error.h"
#include "filters/classes/height.h"
#include "filters/classes/returns.h"
#include "io/las/las_block.h"
#include "io/las/las_header.h"
#include "stages/adapters/adapters.h"
#include "stages/tile.h"

namespace swath::stages {
namespace {

using core::Column;

constexpr const char* coarse_times = "times do not distinguish pulses, return numbers left as they are";

struct ReturnsStageOptions : filters::ReturnsOptions {
  bool repair_clouds = false;
};

template <class V>
void describe(ReturnsStageOptions& o, V& v) {
  describe(static_cast<filters::ReturnsOptions&>(o), v);
  v.option("repair_clouds", o.repair_clouds, "Repair numbers of point clouds, too, where the points' times distinguish the pulses.");
}

struct ReturnCounts {
  std::uint64_t repaired = 0, inconsistent = 0, as_they_are = 0;
  filters::StripReturns returns{};  ///< broken down by flight line
};

template <class V>
void describe(const ReturnCounts& r, V& v) {
  using core::if_any;
  v.result("return numbers repaired", r.repaired, if_any(), "Returns whose number or count was changed.");
  v.result("return numbers inconsistent, flagged", r.inconsistent, if_any(), "Returns that keep numbers which cannot be.");
  v.result(coarse_times, r.as_they_are, if_any(), "Returns of such clouds.");
  describe(r.returns, v);
}

class Returns : public OptionStage<ReturnsStageOptions, ReturnCounts> {
 public:
  const Info& info() const override {
    static const Info info{
        "filters.returns",
        "First, last, only and intermediate returns: missing or inconsistent numbers repaired or flagged, returns per pulse by line.",
        {Grain::strip},
        {Column::time, Column::return_number, Column::return_count},
        {Column::return_number, Column::return_count, Column::flags},
        {Product::points},
        {}};
    return info;
  }
  void run_strip(const Context& context, StripBatch& batch, core::Tally& tally) const override {
    // A cloud may be cropped, thinned or dated to the second: its numbers are its maker's.
    const bool is_cloud = context.source && context.source->info().makes(Product::points);
    if (!is_cloud) {
      repair(batch.block, options, tally);
    } else if (options.repair_clouds) {
      filters::ReturnsOptions careful = options;
      careful.gaps = filters::Gaps::keep;  // returns beyond a crop's rim are absent rightly
      if (filters::tells_pulses(batch.block))
        repair(batch.block, careful, tally);
      else
        tally.count(coarse_times, batch.block.size());
    }
    std::map<std::uint16_t, filters::StripReturns> lines;
    filters::count_returns(batch.block, lines);
    for (const auto& [line, returns] : lines) {
      core::Tally of_line;
      core::count_results(returns, of_line);
      tally.add(of_line, line);
    }
  }

 private:
  static void repair(core::Block& block, const filters::ReturnsOptions& o, core::Tally& tally) {
    const filters::RepairCounts n = filters::repair_returns(block, o);
    if (n.repaired) tally.count("return numbers repaired", n.repaired);
    if (n.inconsistent) tally.count("return numbers inconsistent, flagged", n.inconsistent);
  }
};

struct HeightCounts {
  std::uint64_t unknown = 0;
};

template <class V>
void describe(const HeightCounts& r, V& v) {
  v.result("above a void of the DTM: height unknown", r.unknown, core::if_any(), "Points without a height above ground.");
}

HeightCounts set_heights(TileJob& job, const In<Product::dtm>& terrain) {
  return {filters::height_above(terrain.over(job.box.grown(1.5 * terrain.cell())), job.block, job.own)};
}

}  // namespace

void expect_ranges(const Context& context, std::string_view stage, core::TileColumns columns) {
  // Ranges come from raw records; a cloud has them only where its files say so.
  if (!columns.reads.has(Column::range) || !context.source || !context.source->info().makes(Product::points)) return;
  for (const io::PointFile& f : context.survey.points) {
    const std::filesystem::path file = io::resolve(context.survey, f.file);
    std::vector<std::string> ignored;
    if (!io::read_las_header(file, ignored).extra_offset(io::las_name::range))
      throw core::usage_error(std::string(stage) + ": range_min and range_max need the points' ranges, which the file does not have",
                              file.string(), "leave the range gate out, or start from raw laser records");
  }
}

Entry returns_stage() { return {"filters.returns", std::make_unique<Returns>}; }
Entry hag_dem_stage() {
  return tile<set_heights>("filters.hag_dem", "Height of every point above the DTM, bilinear between cell centres.",
                           {.columns = {.needs = {}, .gives = {Column::height}}, .memory = [](const NoOptions&, const Context& c) {
                              return TileMemory{16.0, window_of(c, Product::dtm, 0)};
                            }});
}

}  // namespace swath::stages
