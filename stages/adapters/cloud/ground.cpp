// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/ground.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "stages/adapters/adapters.h"
#include "stages/line_comparison.h"
#include "stages/tile_filter.h"

namespace swath::stages {
namespace {

/// "middle 500123 5300456, 300 m x 200 m, walls of 12 m".
std::string text_of(const filters::RaisedSurface& r, const Context& context) {
  const auto whole = [](double v) { return std::to_string(std::llround(v)); };
  return "middle " + whole(r.east / context.unit) + " " + whole(r.north / context.unit) + ", " + whole(r.length) + " m x " +
         whole(r.width) + " m, walls of " + whole(r.rise) + " m";
}

/// filters.ground, with what is known of the run's flight lines.
class Ground : public ClassFilter<filters::classify_ground, true> {
 public:
  using ClassFilter::ClassFilter;
  std::string_view implied(bool) const override { return "quality.lines"; }
  double near_halo() const override { return filters::near_halo(options); }
  double left_per_area() const override { return 1.0; }
  void thin(const Context& context, const Box& tiles, core::Block& around) const override {
    std::vector<double> heights = around.z;
    if (const std::optional<quality::KnownLines> lines = known_lines(context)) quality::take_offsets(around, *lines);
    const std::vector<std::uint32_t> rows = filters::needed_around(around, {tiles.x0, tiles.y0, tiles.x1, tiles.y1}, options);
    around.z.swap(heights);
    around = core::select(around, rows);
  }
  void run_tile(const Context& context, TileJob& job) const override {
    filters::GroundOptions o = options;
    if (const std::optional<quality::KnownLines> lines = known_lines(context)) {
      quality::take_offsets(job.block, *lines);  // of this copy: heights are not among what the stage gives
      if (!std::isnan(lines->residual)) o.noise.value = std::hypot(o.noise.value, lines->residual);
    }
    const KeptClasses kept(job.block, options.keep_classes);
    const filters::GroundChances n = filters::classify_ground(job.block, job.own, o);
    core::count_results(kept.put_back(job.block, job.own, true,
                                      [&](size_t i) { job.block.ground_probability[i] = std::numeric_limits<float>::quiet_NaN(); }),
                        job.tally);
    core::count_results(n, job.tally);
    for (const filters::RaisedSurface& r : n.raised)
      if (r.x >= job.box.x0 && r.x < job.box.x1 && r.y >= job.box.y0 && r.y < job.box.y1)
        job.tally.count("warning: wide surfaces between walls kept as ground; buildings among them need a larger longest",
                        text_of(r, context));
  }
};

}  // namespace

Entry ground_stage() {
  return entry_of<Ground>("filters.ground",
                          "Ground points by a robust surface through the last returns, with a probability of bare ground for every point.",
                          {});
}

}  // namespace swath::stages
