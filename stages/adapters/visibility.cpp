// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/visibility.h"

#include <limits>
#include <mutex>

#include "calib/map_patch.h"
#include "io/geotiff.h"
#include "io/vrt.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/tile_list.h"
#include "stages/adapters/units.h"
#include "stages/grid_tile.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
using core::Column;

class Visibility : public OptionStage<filters::VisibilityOptions> {
 public:
  const Info& info() const override {
    static const Info info{
        "filters.visibility",
        "Follows the beams from the scanner to their returns: noise in space found empty, penetration, gap fraction by height, ground "
        "never "
        "seen.",
        {Grain::tile, Grain::merge},
        {Column::time, Column::strip, Column::return_number, Column::return_count, Column::flags, Column::classification},
        {Column::flags, Column::classification},
        {Product::trajectory, Product::points},
        {Product::visibility}};
    return info;
  }
  double halo() const override { return filters::halo(options); }
  // The octree, the scanner's positions (24) and the order of the returns (8).
  double bytes_per_point() const override { return 32.0 + filters::visibility_bytes(options); }
  std::vector<std::string> products() const override { return {"visibility", "visibility.vrt"}; }

  void run_tile(const Context& context, TileJob& job) const override {
    const core::Lattice lattice = lattice_in(options.cell.value, job.box);
    filters::Visibility v;
    const filters::VisibilityCounts n =
        filters::trace_visibility(job.block, job.own, scanner_positions(context, job.block), lattice, options, v);
    job.tally.count("high noise", n.noise);
    if (n.untouched) job.tally.count("withheld or noise already, not looked at", n.untouched);
    if (n.no_position) job.tally.count("outside the trajectory: beam not followed", n.no_position);
    const core::Grid seen = v.seen();
    std::uint64_t cells = 0, never = 0;
    for (const core::Void r : seen.reason) cells += r != core::Void::no_data, never += r == core::Void::never_seen;
    job.tally.count("cells with beams", cells);
    if (never) job.tally.count("cells whose ground was never seen", never);
    write_grid_tile(job.folder, job.key, seen);
    write_bands(context, job.key, v);
  }

  void run_merge(const Context& context, MergeJob& job) const override {
    std::vector<std::string> files;
    std::vector<fs::path> tiles;
    double cells = 0, never = 0;
    for (const TileKey key : job.tiles) {
      files.push_back(name(context, key));
      tiles.push_back(context.output / "visibility" / files.back());
      for (const core::Void r : read_grid_tile(grid_file(job.folder, key)).reason)
        cells += r != core::Void::no_data, never += r == core::Void::never_seen;
    }
    io::write_vrt(context.output / "visibility.vrt", tiles);
    write_list(context.output / "visibility", files);
    if (cells > 0) job.findings["never_seen_share"] = never / cells;
  }

 private:
  static std::string name(const Context& context, TileKey key) { return "visibility_" + context.label(key) + ".tif"; }

  /// Relative to the block's origin, m; NaN where the trajectory does not reach.
  std::vector<Eigen::Vector3d> scanner_positions(const Context& context, const core::Block& block) const {
    const std::shared_ptr<const calib::MapPatches> map = patches(context);
    Eigen::Vector3d lever;
    for (Eigen::Index a = 0; a < 3; ++a) lever[a] = context.survey.calibration.lever_arm_scanner[static_cast<size_t>(a)].value;
    const Eigen::Vector3d unit(context.unit, context.unit, context.crs.vertical_metres_per_unit());
    std::vector<Eigen::Vector3d> out(block.size(), Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
    trajectory::Cursor cursor(*context.trajectory);
    for (size_t p = 0; p < block.size(); ++p) {
      if (p > 0 && block.time[p] == block.time[p - 1]) {
        out[p] = out[p - 1];
      } else if (cursor.seek(block.time[p])) {
        const trajectory::Pose pose = cursor.pose(block.time[p]);
        out[p] = (*map)(pose.position + pose.ecef_R_body * lever).cwiseProduct(unit) - block.origin;
      }
    }
    return out;
  }

  void write_bands(const Context& context, TileKey key, const filters::Visibility& v) const {
    const size_t n = v.lattice.size();
    std::vector<std::vector<float>> columns(static_cast<size_t>(v.layers) + 4, std::vector<float>(n));
    const core::Grid seen = v.seen();
    for (size_t c = 0; c < n; ++c) {
      columns[0][c] = static_cast<float>(v.penetration(c));
      columns[1][c] = static_cast<float>(v.gap_fraction(c));
      columns[2][c] = static_cast<float>(v.pulses[c]);
      columns[3][c] = seen.reason[c] == core::Void::no_data ? std::numeric_limits<float>::quiet_NaN()
                                                            : (seen.reason[c] == core::Void::never_seen ? 1.0f : 0.0f);
      for (int k = 0; k < v.layers; ++k) columns[static_cast<size_t>(k) + 4][c] = static_cast<float>(v.gap(c, k));
    }
    std::vector<io::RasterBand> bands{{"penetration rate", "", &columns[0]},
                                      {"gap fraction", "", &columns[1]},
                                      {"pulses", "", &columns[2]},
                                      {"ground never seen", "", &columns[3]}};
    for (int k = 0; k < v.layers; ++k)
      bands.push_back({"gap fraction from " + core::format_quantity(core::Dimension::length, k * options.voxel.value), "",
                       &columns[static_cast<size_t>(k) + 4]});
    io::write_raster(context.output / "visibility" / name(context, key), in_crs_units(context, v.lattice), bands, context.product_crs,
                     true);
  }

  std::shared_ptr<const calib::MapPatches> patches(const Context& context) const {
    const std::lock_guard lock(mutex_);
    if (!patches_) patches_ = std::make_shared<calib::MapPatches>(context.crs);
    return patches_;
  }
  mutable std::mutex mutex_;
  mutable std::shared_ptr<const calib::MapPatches> patches_;
};

}  // namespace

std::unique_ptr<Stage> make_visibility() { return std::make_unique<Visibility>(); }

}  // namespace swath::stages
