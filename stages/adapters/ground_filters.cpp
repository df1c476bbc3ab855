// SPDX-License-Identifier: GPL-3.0-or-later
// Ground filters that share one door: usable last returns in, class ground or unassigned out.
#include "filters/csf.h"
#include "filters/ground_ptd.h"
#include "filters/pmf.h"
#include "filters/robust.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/kept_classes.h"

namespace swath::stages {
namespace {

using core::Column;

Info ground_filter(std::string_view name, std::string_view summary) {
  return {name, summary, {Grain::tile}, {Column::flags}, {Column::classification}, {Product::points}, {}};
}

void tell(const filters::GroundCounts& n, core::Tally& tally) {
  tally.count("ground", n.ground);
  tally.count("not ground", n.object);
  if (n.early) tally.count("early returns, not ground", n.early);
  if (n.untouched) tally.count("withheld or noise, not looked at", n.untouched);
  if (n.no_surface) tally.count("no ground within reach", n.no_surface);
}

std::vector<Raster> no_rasters(const filters::PtdOptions&) { return {}; }
std::vector<Raster> no_rasters(const filters::RobustOptions&) { return {}; }

// A square of filters/patches.h with its margins is 4/3 of the halo wide, in both filters. Measured 2026-11-22 with
// tests/stages/memory_test.cpp, tile 100 m: 140 bytes per cell (pmf), 56 and 64 (csf, resolution 0.5 and 1 m).
constexpr double patch_per_halo = 4.0 / 3.0;
std::vector<Raster> rasters_of(const filters::PmfOptions& o) {
  return {{"cell_size", o.cell_size.value, patch_per_halo * filters::halo(o), 150.0}};
}
std::vector<Raster> rasters_of(const filters::CsfOptions& o) {
  return {{"resolution", o.resolution.value, patch_per_halo * filters::halo(o), 72.0}};
}

template <class O, filters::GroundCounts (*classify)(core::Block&, size_t, const O&), std::vector<Raster> (*rasters_of_tile)(const O&)>
class GroundFilter : public OptionStage<Keeping<O>> {
 public:
  explicit GroundFilter(const Info& info, double bytes) : info_(info), bytes_(bytes) {}
  std::vector<Raster> rasters(const Context&) const override { return rasters_of_tile(this->options); }
  const Info& info() const override { return info_; }
  core::ColumnSet also_reads() const override { return {Column::return_number, Column::return_count}; }
  double halo() const override { return filters::halo(this->options); }
  double bytes_per_point() const override { return bytes_; }
  void run_tile(const Context&, TileJob& job) const override {
    const KeptClasses kept(job.block, this->options.keep_classes);
    tell(classify(job.block, job.own, this->options), job.tally);
    kept.put_back(job.block, job.own, true, job.tally);
  }

 private:
  const Info& info_;
  double bytes_;
};

using Ptd = GroundFilter<filters::PtdOptions, filters::classify_ground_ptd, no_rasters>;
using Robust = GroundFilter<filters::RobustOptions, filters::classify_ground_robust, no_rasters>;
using Pmf = GroundFilter<filters::PmfOptions, filters::classify_ground_pmf, rasters_of>;
using Csf = GroundFilter<filters::CsfOptions, filters::classify_ground_csf, rasters_of>;

}  // namespace

std::unique_ptr<Stage> make_ptd() {
  static const Info info = ground_filter("filters.ptd", "Ground points by progressive TIN densification (Axelsson 2000).");
  return std::make_unique<Ptd>(info, 230.0);
}
std::unique_ptr<Stage> make_robust() {
  static const Info info =
      ground_filter("filters.robust", "Ground points by hierarchic robust interpolation (Kraus and Pfeifer 1998; Pfeifer et al. 2001).");
  return std::make_unique<Robust>(info, 600.0);
}
std::unique_ptr<Stage> make_pmf() {
  static const Info info = ground_filter("filters.pmf", "Ground points by the progressive morphological filter (Zhang et al. 2003).");
  return std::make_unique<Pmf>(info, 80.0);
}
std::unique_ptr<Stage> make_csf() {
  static const Info info = ground_filter("filters.csf", "Ground points by cloth simulation (Zhang et al. 2016).");
  return std::make_unique<Csf>(info, 80.0);
}

}  // namespace swath::stages
