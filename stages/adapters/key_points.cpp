// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/key_points.h"

#include "stages/adapters/adapters.h"

namespace swath::stages {
namespace {

class KeyPoints : public OptionStage<terrain::KeyPointOptions> {
 public:
  const Info& info() const override {
    static const Info info{"filters.key_points",
                           "Model key points: flags the ground points whose triangulation stays within a tolerance of all of them.",
                           {Grain::tile},
                           {core::Column::classification, core::Column::flags},
                           {core::Column::flags},
                           {Product::points},
                           {}};
    return info;
  }
  double halo() const override { return terrain::halo(options); }
  // As the terrain model's, and the seats of the points of a cell.
  double bytes_per_point() const override { return 260.0; }
  void run_tile(const Context&, TileJob& job) const override {
    const terrain::KeyPointCounts n = terrain::mark_key_points(job.block, job.own, options);
    job.tally.count("ground points", n.terrain);
    job.tally.count("key points", n.key);
  }
};

}  // namespace

std::unique_ptr<Stage> make_key_points() { return std::make_unique<KeyPoints>(); }

}  // namespace swath::stages
