// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "core/config/result_visitors.h"
#include "filters/classes/returns.h"
#include "io/raster/geotiff.h"
#include "io/raster/vrt.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/cloud/tile_list.h"
#include "stages/adapters/units.h"
#include "stages/grid_tile.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
using core::Column;

struct PenetrationOptions {
  core::Metres cell{10.0};
};

template <class V>
void describe(PenetrationOptions& o, V& v) {
  v.option("cell", o.cell, core::above(0.0), "Side of one cell.");
}

struct PulseCounts {
  std::uint64_t pulses = 0, reached = 0;
};

template <class V>
void describe(const PulseCounts& r, V& v) {
  v.result("pulses", r.pulses, "Pulses with a usable last return.");
  v.result("pulses that reached the ground", r.reached, "Of those: pulses whose last return is of class ground.");
}

struct PenetrationFindings {
  double rate = std::numeric_limits<double>::quiet_NaN();
};

template <class V>
void describe(const PenetrationFindings& r, V& v) {
  v.result("penetration_rate", r.rate, core::share().in_summary(), "Share of pulses that reached the ground.");
}

class Penetration : public OptionStage<PenetrationOptions, PulseCounts, PenetrationFindings> {
 public:
  const Info& info() const override {
    static const Info info{"terrain.penetration",
                           "Penetration rate by cell, pulses that reached the ground over all pulses, and returns per pulse, as GeoTIFF.",
                           {Grain::tile, Grain::merge},
                           {Column::return_number, Column::return_count, Column::classification, Column::flags},
                           {},
                           {Product::points},
                           {}};
    return info;
  }
  double halo() const override { return options.cell.value; }
  // Measured 2026-11-22 with tests/stages/memory_test.cpp, tile 200 m, cells of 0.5 m: 100 bytes per cell.
  std::vector<Raster> rasters(const Context& c) const override { return {{"cell", options.cell.value, c.tile_side, 104.0}}; }
  std::vector<std::string> products() const override { return {"penetration", "penetration.vrt"}; }

  void run_tile(const Context& context, TileJob& job) const override {
    const core::Lattice lattice = lattice_in(options.cell.value, job.box);
    const filters::Penetration p = filters::penetration(job.block, job.block.size(), lattice);
    std::vector<float> rate(lattice.size()), per_pulse(lattice.size()), pulses(lattice.size());
    constexpr float none = std::numeric_limits<float>::quiet_NaN();
    for (size_t c = 0; c < lattice.size(); ++c) {
      rate[c] = static_cast<float>(p.rate(c));
      per_pulse[c] = p.pulses[c] ? static_cast<float>(p.returns[c]) / static_cast<float>(p.pulses[c]) : none;
      pulses[c] = static_cast<float>(p.pulses[c]);
    }
    io::write_raster(context.output / "penetration" / name(context, job.key), in_crs_units(context, lattice),
                     {{"penetration rate", "", &rate}, {"returns per pulse", "", &per_pulse}, {"pulses", "", &pulses}}, context.product_crs,
                     true);
    const std::uint64_t sums[2] = {std::accumulate(p.pulses.begin(), p.pulses.end(), std::uint64_t{0}),
                                   std::accumulate(p.ground_pulses.begin(), p.ground_pulses.end(), std::uint64_t{0})};
    core::count_results(PulseCounts{sums[0], sums[1]}, job.tally);
    io::write_text_file(job.folder / (context.label(job.key) + ".sums"), {reinterpret_cast<const char*>(sums), sizeof sums});
  }

  void run_merge(const Context& context, MergeJob& job) const override {
    std::vector<std::string> files;
    std::vector<fs::path> tiles;
    std::uint64_t all[2] = {0, 0};
    for (const TileKey key : job.tiles) {
      files.push_back(name(context, key));
      tiles.push_back(context.output / "penetration" / files.back());
      std::uint64_t sums[2];
      const fs::path file = job.folder / (context.label(key) + ".sums");
      const std::string bytes = io::read_text_file(file);
      if (bytes.size() != sizeof sums) io::cut_short(file);
      std::memcpy(sums, bytes.data(), sizeof sums);
      all[0] += sums[0];
      all[1] += sums[1];
    }
    io::write_vrt(context.output / "penetration.vrt", tiles);
    write_list(context.output / "penetration", files);
    if (all[0]) job.findings = core::reported(PenetrationFindings{static_cast<double>(all[1]) / static_cast<double>(all[0])});
  }

 private:
  static std::string name(const Context& context, TileKey key) { return "penetration_" + context.label(key) + ".tif"; }
};

}  // namespace

std::unique_ptr<Stage> make_penetration() { return std::make_unique<Penetration>(); }

}  // namespace swath::stages
