// SPDX-License-Identifier: GPL-3.0-or-later
// The run against what is known of a simulated survey: every return by its record, the ground labels, the terrain.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>

#include "core/error.h"
#include "io/geotiff.h"
#include "io/npy.h"
#include "io/output_file.h"
#include "io/value_file.h"
#include "stages/adapters/adapters.h"
#include "stages/grid_tile.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
using core::Column;

/// Sums of errors: plain numbers, so that tiles add up in any order of work but one order of adding.
struct Sums {
  double n = 0, sum[3] = {}, square[3] = {}, ratio_h = 0, ratio_v = 0, with_sigma = 0, largest = 0;
  double ground_kept = 0, ground_lost = 0, object_kept = 0, object_taken = 0;

  void add(const Sums& o) {
    n += o.n;
    for (int k = 0; k < 3; ++k) sum[k] += o.sum[k], square[k] += o.square[k];
    ratio_h += o.ratio_h;
    ratio_v += o.ratio_v;
    with_sigma += o.with_sigma;
    largest = std::max(largest, o.largest);
    ground_kept += o.ground_kept;
    ground_lost += o.ground_lost;
    object_kept += o.object_kept;
    object_taken += o.object_taken;
  }
};

fs::path sums_file(const fs::path& folder, TileKey key) {
  return folder / (std::to_string(key.ix) + "_" + std::to_string(key.iy) + ".sums");
}

struct NoOptions {};
template <class V>
void describe(NoOptions&, V&) {}

class Truth : public OptionStage<NoOptions> {
 public:
  const Info& info() const override {
    static const Info info{"report.truth",
                           "Errors against truth, where the survey names it: points, their sigmas, ground labels, terrain.",
                           {Grain::tile, Grain::merge},
                           {Column::record, Column::strip},
                           {},
                           {Product::points},
                           {}};
    return info;
  }
  core::ColumnSet also_reads() const override { return {Column::sigma_h, Column::sigma_v, Column::classification}; }

  std::vector<fs::path> inputs(const io::Survey& survey) const override {
    std::vector<fs::path> out;
    for (const auto& f : {survey.truth.returns, survey.truth.dtm})
      if (f) out.push_back(io::resolve(survey, *f));
    return out;
  }

  void check(const Context& context) const override {
    if (context.survey.truth.returns && context.survey.laser.size() > 1)
      throw core::usage_error("report.truth: truth.returns has one row per record of one laser file; the survey names " +
                                  std::to_string(context.survey.laser.size()),
                              context.survey.name, "compare one file at a time, or leave truth.returns out");
  }

  void run_tile(const Context& context, TileJob& job) const override {
    Sums sums;
    if (context.survey.truth.returns) sums = compare(context, job.block, job.own);
    io::write_text_file(sums_file(job.folder, job.key), {reinterpret_cast<const char*>(&sums), sizeof sums});
  }

  void run_merge(const Context& context, MergeJob& job) const override {
    if (!context.survey.truth.returns && !context.survey.truth.dtm) {
      job.findings["truth"] = "none: the survey names no truth";
      return;
    }
    Sums all;
    for (const TileKey key : job.tiles) {
      const std::string bytes = io::read_text_file(sums_file(job.folder, key));
      Sums s;
      if (bytes.size() != sizeof s) cut_short(sums_file(job.folder, key));
      std::memcpy(&s, bytes.data(), sizeof s);
      all.add(s);
    }
    if (all.n > 0) tell_points(all, job.findings);
    if (context.survey.truth.dtm && context.grids->has(Product::dtm)) tell_terrain(context, job);
  }

 private:
  /// Rows of the truth are those of the laser records; a tile's points of one strip rise in record.
  static Sums compare(const Context& context, const core::Block& block, size_t own) {
    const fs::path file = io::resolve(context.survey, *context.survey.truth.returns);
    const io::NpyHeader header = io::read_npy_header(file);
    io::NpyReader truth(file, {io::field_of(header, "e", file), io::field_of(header, "n", file), io::field_of(header, "h", file),
                               io::field_of(header, "cls", file)});
    constexpr size_t window = 1 << 16;
    std::vector<std::vector<double>> columns;
    std::uint64_t first = 0, rows = 0;
    Sums s;
    for (size_t i = 0; i < own; ++i) {
      const std::uint64_t row = block.record[i];
      if (row >= truth.rows())
        throw core::Error("record " + std::to_string(row) + " has no row of truth", file.string(),
                          "truth.returns must have one row per laser record");
      if (row < first || row >= first + rows) {
        first = row;
        rows = std::min<std::uint64_t>(window, truth.rows() - first);
        truth.read(first, rows, columns);
      }
      const size_t k = row - first;
      const auto cls = static_cast<int>(columns[3][k]);
      const std::array<double, 3> e = {block.origin.x() + block.x[i] - columns[0][k] * context.unit,
                                       block.origin.y() + block.y[i] - columns[1][k] * context.unit,
                                       block.origin.z() + block.z[i] - columns[2][k] * context.vertical_unit};
      // Outliers are wrong by what makes them outliers; they count in the labels, not in the errors.
      if (cls != core::point_class::low_noise && cls != core::point_class::high_noise) {
        ++s.n;
        for (size_t a = 0; a < 3; ++a) s.sum[a] += e[a], s.square[a] += e[a] * e[a];
        s.largest = std::max(s.largest, std::hypot(e[0], e[1], e[2]));
        if (!block.sigma_h.empty() && block.sigma_h[i] > 0 && block.sigma_v[i] > 0) {
          const auto h = static_cast<double>(block.sigma_h[i]), v = static_cast<double>(block.sigma_v[i]);
          s.ratio_h += (e[0] * e[0] + e[1] * e[1]) / (h * h);
          s.ratio_v += e[2] * e[2] / (v * v);
          ++s.with_sigma;
        }
      }
      if (!block.classification.empty()) {
        const bool is_ground = cls == core::point_class::ground, said = block.classification[i] == core::point_class::ground;
        ++(is_ground ? (said ? s.ground_kept : s.ground_lost) : (said ? s.object_taken : s.object_kept));
      }
    }
    return s;
  }

  static void tell_points(const Sums& s, core::Value& findings) {
    static constexpr const char* axes[] = {"east", "north", "up"};
    core::Value points = core::Value::object();
    points["compared"] = static_cast<std::int64_t>(s.n);
    double square = 0;
    for (size_t a = 0; a < 3; ++a) {
      points["mean_" + std::string(axes[a]) + "_m"] = s.sum[a] / s.n;
      points["rms_" + std::string(axes[a]) + "_m"] = std::sqrt(s.square[a] / s.n);
      square += s.square[a];
    }
    findings["rms_3d"] = std::sqrt(square / s.n);
    points["largest_3d_m"] = s.largest;
    if (s.with_sigma > 0) {
      points["error_over_sigma_h"] = std::sqrt(s.ratio_h / s.with_sigma);
      points["error_over_sigma_v"] = std::sqrt(s.ratio_v / s.with_sigma);
    }
    findings["points"] = std::move(points);
    if (s.ground_kept + s.object_taken == 0) return;
    core::Value& labels = findings["ground"];
    const double ground = s.ground_kept + s.ground_lost, object = s.object_kept + s.object_taken, n = ground + object;
    labels["type_1_percent"] = 100 * s.ground_lost / std::max(ground, 1.0);
    labels["type_2_percent"] = 100 * s.object_taken / std::max(object, 1.0);
    const double agree = (s.ground_kept + s.object_kept) / n;
    labels["total_error_percent"] = 100 * (1 - agree);
    const double chance = ((ground * (s.ground_kept + s.object_taken)) + (object * (s.ground_lost + s.object_kept))) / (n * n);
    labels["kappa_percent"] = chance < 1 ? 100 * (agree - chance) / (1 - chance) : 100.0;
  }

  static void tell_terrain(const Context& context, MergeJob& job) {
    const fs::path file = io::resolve(context.survey, *context.survey.truth.dtm);
    const double cell = context.grids->cell(Product::dtm);
    const io::RasterInfo raster = io::read_raster_info(file);
    if (std::abs(raster.geotransform[1] * context.unit - cell) > 1e-6 * cell) {
      job.findings["dtm"] = "not compared: the truth has another cell";
      return;
    }
    double n = 0, sum = 0, square = 0, with_sigma = 0, ratio = 0, covered = 0;
    std::map<int, std::uint64_t> histogram;  // |error| in mm
    for (const TileKey key : job.tiles) {
      const core::Lattice own = lattice_in(cell, context.box_of(key));
      const core::Grid mine = context.grids->window(Product::dtm, own);
      core::Lattice in_truth = own;
      in_truth.cell = cell / context.unit;
      const core::Grid truth = io::read_grid(file, in_truth);
      for (size_t k = 0; k < own.size(); ++k) {
        if (truth.reason[k] != core::Void::none) continue;
        ++covered;
        if (mine.reason[k] != core::Void::none) continue;
        const double e = static_cast<double>(mine.height[k]) - static_cast<double>(truth.height[k]) * context.vertical_unit;
        ++n;
        sum += e;
        square += e * e;
        ++histogram[static_cast<int>(std::min(1e8, std::abs(e) * 1000))];
        if (!mine.sigma.empty() && mine.sigma[k] > 0)
          ratio += e * e / (static_cast<double>(mine.sigma[k]) * static_cast<double>(mine.sigma[k])), ++with_sigma;
      }
    }
    core::Value& dtm = job.findings["dtm"];
    dtm["cells"] = static_cast<std::int64_t>(n);
    if (n == 0) return;
    dtm["mean_m"] = sum / n;
    dtm["rms_m"] = std::sqrt(square / n);
    double seen = 0;
    for (const auto& [mm, count] : histogram) {
      if (seen < 0.5 * n && seen + static_cast<double>(count) >= 0.5 * n) dtm["median_abs_m"] = mm / 1000.0;
      if (seen < 0.95 * n && seen + static_cast<double>(count) >= 0.95 * n) dtm["abs_95_percent_m"] = mm / 1000.0;
      seen += static_cast<double>(count);
    }
    if (with_sigma > 0) dtm["error_over_sigma"] = std::sqrt(ratio / with_sigma);
    dtm["truth_without_height_percent"] = 100 * (1 - n / covered);
  }
};

}  // namespace

std::unique_ptr<Stage> make_truth() { return std::make_unique<Truth>(); }

}  // namespace swath::stages
