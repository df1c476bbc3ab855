// SPDX-License-Identifier: GPL-3.0-or-later
// A stage of the registry run on tiles by itself, without the engine.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/config/option_visitors.h"
#include "core/error.h"
#include "io/text/value_file.h"
#include "stages/registry.h"
#include "tests/world/support.h"

namespace swath::stages {

namespace fs = std::filesystem;

inline std::unique_ptr<Stage> stage_with(const std::string& type, const std::string& options) {
  auto stage = make_stage(type);
  std::vector<core::Fault> faults;
  core::read_options([&](core::Visitor& v) { stage->visit(v); }, io::parse_toml(options, "test"), "", faults);
  core::throw_if_any(faults);
  return stage;
}

/// Grids given by a function of the place; folders where tests put files.
class MadeGrids : public Grids {
 public:
  std::map<Product, std::function<void(double, double, float&, core::Void&)>> made;
  std::map<Product, fs::path> folders;
  double side = 1.0;
  bool has(Product p) const override { return made.contains(p) || folders.contains(p); }
  core::Grid window(Product p, const core::Lattice& lattice) const override {
    core::Grid g(lattice);
    for (int j = 0; j < lattice.ny; ++j)
      for (int i = 0; i < lattice.nx; ++i)
        made.at(p)(lattice.centre_x(i), lattice.centre_y(j), g.height[lattice.at(i, j)], g.reason[lattice.at(i, j)]);
    return g;
  }
  fs::path folder(Product p) const override { return folders.at(p); }
  double cell(Product) const override { return side; }
};

struct Work {
  test::TemporaryFolder folder;
  io::Survey survey;
  MadeGrids grids;
  Context context{survey};
  Work() {
    context.grids = &grids;
    context.output = folder / "products";
    context.product_crs = "EPSG:32632";
  }
  /// Runs the stage on tile (ix, iy) with the points of `all` that it asks for; what it has counted.
  core::Tally run(const Stage& stage, const core::Block& all, int ix, int iy, const fs::path& where) const {
    return run_in(stage, all, {ix, iy}, context.box_of({ix, iy}), where);
  }
  /// The same on a part of the tile.
  core::Tally run_in(const Stage& stage, const core::Block& all, TileKey key, const Box& part, const fs::path& where) const {
    TileJob job{key, part, where, {}, 0, {}};
    fs::create_directories(where);
    std::vector<std::uint32_t> own, around;
    const Box grown = job.box.grown(stage.halo());
    for (std::uint32_t p = 0; p < all.size(); ++p) {
      const double x = all.origin.x() + all.x[p], y = all.origin.y() + all.y[p];
      if (job.box.holds(x, y))
        own.push_back(p);
      else if (grown.holds(x, y))
        around.push_back(p);
    }
    job.own = own.size();
    own.insert(own.end(), around.begin(), around.end());
    job.block = core::select(all, own);
    stage.run_tile(context, job);
    return job.tally;
  }
  /// Runs it on every tile that holds points, then its merge; what both have counted together, and what the merge has found.
  MergeJob run_all(const Stage& stage, const core::Block& all, const fs::path& where) const {
    std::set<TileKey> keys;
    for (size_t p = 0; p < all.size(); ++p)
      keys.insert({static_cast<int>(std::floor((all.origin.x() + all.x[p]) / context.tile_side)),
                   static_cast<int>(std::floor((all.origin.y() + all.y[p]) / context.tile_side))});
    MergeJob out{where, {keys.begin(), keys.end()}, {}};
    for (const TileKey key : out.tiles) out.tally.add(run(stage, all, key.ix, key.iy, where));
    out.of_tiles = out.tally;
    stage.run_merge(context, out);
    return out;
  }
};

inline std::string fault_of(const std::function<void()>& run) {
  try {
    run();
  } catch (const core::Error& e) {
    return e.text();
  }
  return "";
}

}  // namespace swath::stages
