// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>
#include <numeric>

#include "filters/classes/returns.h"
#include "stages/adapters/adapters.h"
#include "stages/tile.h"
#include "stages/tile_product.h"

namespace swath::stages {
namespace {

using core::Column;

struct PenetrationOptions {
  core::Metres cell{10.0};
};

template <class V>
void describe(PenetrationOptions& o, V& v) {
  v.option("cell", o.cell, core::above(0.0), "Side of one cell.");
}

double halo(const PenetrationOptions& o) { return o.cell.value; }

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

std::filesystem::path sums_file(const std::filesystem::path& folder, TileKey key) { return piece_file(folder, key, "sums"); }

PulseCounts map_penetration(const TileJob& job, const Context& context, const PenetrationOptions& o) {
  const core::Lattice lattice = lattice_in(o.cell.value, job.box);
  const filters::Penetration p = filters::penetration(job.block, job.block.size(), lattice);
  std::vector<float> rate(lattice.size()), per_pulse(lattice.size()), pulses(lattice.size());
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  for (size_t c = 0; c < lattice.size(); ++c) {
    rate[c] = static_cast<float>(p.rate(c));
    per_pulse[c] = p.pulses[c] ? static_cast<float>(p.returns[c]) / static_cast<float>(p.pulses[c]) : none;
    pulses[c] = static_cast<float>(p.pulses[c]);
  }
  TileRasters{context, "penetration"}.write(
      job.key, lattice, {{"penetration rate", "", &rate}, {"returns per pulse", "", &per_pulse}, {"pulses", "", &pulses}});
  const PulseCounts sums{std::accumulate(p.pulses.begin(), p.pulses.end(), std::uint64_t{0}),
                         std::accumulate(p.ground_pulses.begin(), p.ground_pulses.end(), std::uint64_t{0})};
  write_rows(sums_file(job.folder, job.key), std::vector{sums});
  return sums;
}
PenetrationFindings sum_penetration(const MergeJob& job, const Context& context) {
  std::vector<PulseCounts> tiles;
  for (const TileKey key : job.tiles) read_rows(sums_file(job.folder, key), tiles);
  TileRasters{context, "penetration"}.finish(job.tiles);
  PulseCounts all;
  for (const PulseCounts& t : tiles) all.pulses += t.pulses, all.reached += t.reached;
  return {static_cast<double>(all.reached) / static_cast<double>(all.pulses)};  // not a number without pulses
}

}  // namespace

Entry penetration_stage() {
  return tile<map_penetration, sum_penetration>(
      "terrain.penetration", "Penetration rate by cell, pulses that reached the ground over all pulses, and returns per pulse, as GeoTIFF.",
      {.columns = {.needs = {Column::return_number, Column::return_count, Column::classification, Column::flags}},
       // Measured 2026-11-22 with tests/stages/memory_test.cpp, tile 200 m, cells of 0.5 m: 100 bytes per cell.
       .memory =
           [](const PenetrationOptions& o, const Context& c) {
             return TileMemory{64.0, {{"cell", o.cell.value, c.tile_side, 104.0}}};
           },
       .products =
           [](const PenetrationOptions&) {
             return std::vector<std::string>{"penetration", "penetration.vrt"};
           }});
}

}  // namespace swath::stages
