// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground.h"

#include "stages/adapters/adapters.h"

namespace swath::stages {
namespace {

using core::Column;

class Ground : public OptionStage<filters::GroundOptions> {
 public:
  const Info& info() const override {
    static const Info info{"filters.ground",
                           "Ground points by a robust surface through the last returns, with a probability of bare ground for every point.",
                           {Grain::tile},
                           {Column::flags},
                           {Column::classification, Column::ground_probability},
                           {Product::points},
                           {}};
    return info;
  }
  core::ColumnSet also_reads() const override { return {Column::return_number, Column::return_count, Column::strip}; }
  double halo() const override { return filters::halo(options); }
  // Measured 2026-11-22 with tests/stages/memory_test.cpp, tiles of 200 to 1500 m, points 0.7 m and 3 m apart; of the points, counted
  // 2026-11-23: evidence 64, nearest returns 32.
  double bytes_per_point() const override { return 100.0; }
  std::vector<Raster> rasters(const Context& c) const override {
    return {{"", 1.0, c.tile_side + 2.0 * halo(), 90.0}, {"", 1.0, c.tile_side, 70.0}};
  }
  void run_tile(const Context&, TileJob& job) const override {
    const filters::GroundChances n = filters::classify_ground(job.block, job.own, options);
    job.tally.count("ground", n.ground);
    job.tally.count("not ground", n.object);
    job.tally.count("doubtful: probability between 0.25 and 0.75", n.doubtful);
    if (n.early) job.tally.count("not a last return, not ground", n.early);
    if (n.untouched) job.tally.count("withheld or noise, not looked at", n.untouched);
    if (n.no_surface) job.tally.count("no ground within reach", n.no_surface);
  }
};

}  // namespace

std::unique_ptr<Stage> make_ground() { return std::make_unique<Ground>(); }

}  // namespace swath::stages
