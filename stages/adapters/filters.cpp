// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/error.h"
#include "filters/height.h"
#include "filters/noise.h"
#include "filters/returns.h"
#include "filters/smrf.h"
#include "stages/adapters/adapters.h"

namespace swath::stages {
namespace {

using core::Column;

class Smrf : public OptionStage<filters::SmrfOptions> {
 public:
  const Info& info() const override {
    static const Info info{"filters.smrf",
                           "Ground points by the Simple Morphological Filter (Pingel, Clarke and McBride 2013).",
                           {Grain::tile},
                           {Column::flags},
                           {Column::classification},
                           {Product::points},
                           {}};
    return info;
  }
  core::ColumnSet also_reads() const override { return {Column::return_number, Column::return_count}; }
  double halo() const override { return filters::halo(options); }
  void run_tile(const Context&, TileJob& job) const override {
    const filters::SmrfCounts n = filters::classify_ground_smrf(job.block, job.own, options);
    job.tally.count("ground", n.ground);
    job.tally.count("not ground", n.object);
    if (n.untouched) job.tally.count("withheld or noise, not looked at", n.untouched);
    if (n.no_surface) job.tally.count("no ground within reach", n.no_surface);
  }
};

struct NoOptions {};
template <class V>
void describe(NoOptions&, V&) {}

class HeightAboveGround : public OptionStage<NoOptions> {
 public:
  const Info& info() const override {
    static const Info info{"filters.hag_dem",
                           "Height of every point above the DTM, bilinear between cell centres.",
                           {Grain::tile},
                           {},
                           {Column::height},
                           {Product::points, Product::dtm},
                           {}};
    return info;
  }
  void run_tile(const Context& context, TileJob& job) const override {
    const double cell = context.grids->cell(Product::dtm);
    const core::Grid terrain = context.grids->window(Product::dtm, lattice_in(cell, job.box.grown(1.5 * cell)));
    const std::uint64_t unknown = filters::height_above(terrain, job.block, job.own);
    if (unknown) job.tally.count("above a void of the DTM: height unknown", unknown);
  }
};

}  // namespace

std::unique_ptr<Stage> make_smrf() { return std::make_unique<Smrf>(); }
std::unique_ptr<Stage> make_hag_dem() { return std::make_unique<HeightAboveGround>(); }

}  // namespace swath::stages
