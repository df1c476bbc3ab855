// SPDX-License-Identifier: GPL-3.0-or-later
// The run against what is known of a simulated survey: every return by its record, the ground labels, the terrain.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "io/raster/geotiff.h"
#include "io/text/npy.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
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

using Figure = std::optional<double>;

struct PointErrors {
  std::uint64_t compared = 0;
  std::array<double, 3> mean{}, rms{};
  double largest = 0.0;
  Figure error_over_sigma_h{}, error_over_sigma_v{};
};

template <class V>
void describe(const PointErrors& r, V& v) {
  using core::metres;
  v.result("compared", r.compared, "Points that were compared with their record's truth; outliers are not among them.");
  v.result("mean_east_m", r.mean[0], metres(), "Mean error to the east.");
  v.result("rms_east_m", r.rms[0], metres(), "RMS error to the east.");
  v.result("mean_north_m", r.mean[1], metres(), "Mean error to the north.");
  v.result("rms_north_m", r.rms[1], metres(), "RMS error to the north.");
  v.result("mean_up_m", r.mean[2], metres(), "Mean error of the height.");
  v.result("rms_up_m", r.rms[2], metres(), "RMS error of the height.");
  v.result("largest_3d_m", r.largest, metres(), "Largest distance of a point from its truth.");
  v.result("error_over_sigma_h", r.error_over_sigma_h, core::plain(2), "RMS of horizontal error / sigma_h; 1 where the sigmas are right.");
  v.result("error_over_sigma_v", r.error_over_sigma_v, core::plain(2), "RMS of height error / sigma_v; 1 where the sigmas are right.");
}

struct LabelErrors {
  double type_1 = 0, type_2 = 0, total = 0, kappa = 0;
};

template <class V>
void describe(const LabelErrors& r, V& v) {
  using core::percent;
  v.result("type_1_percent", r.type_1, percent(2).in_summary(), "Ground returns that were rejected.");
  v.result("type_2_percent", r.type_2, percent(2).in_summary(), "Other returns that were accepted as ground.");
  v.result("total_error_percent", r.total, percent(2).in_summary(), "Returns with the wrong label.");
  v.result("kappa_percent", r.kappa, percent(2).in_summary(), "Cohen's kappa.");
}

struct TerrainErrors {
  std::uint64_t cells = 0;
  Figure mean{}, rms{}, median_abs{}, abs_95{}, error_over_sigma{}, truth_without_height{};
};

template <class V>
void describe(const TerrainErrors& r, V& v) {
  using core::metres;
  v.result("cells", r.cells, "Cells that were compared.");
  v.result("mean_m", r.mean, metres().in_summary(), "Mean error of the height.");
  v.result("rms_m", r.rms, metres().in_summary(), "RMS error of the height.");
  v.result("median_abs_m", r.median_abs, metres(), "Median absolute error.");
  v.result("abs_95_percent_m", r.abs_95, metres(), "Absolute error that 95 % of the cells do not exceed.");
  v.result("error_over_sigma", r.error_over_sigma, core::plain(2), "RMS of error / sigma; 1 where the sigmas are right.");
  v.result("truth_without_height_percent", r.truth_without_height, core::percent(2), "Cells of the truth without a height in the model.");
}

struct TruthFindings {
  std::optional<std::string> truth{};
  Figure rms_3d{};
  std::optional<PointErrors> points{};
  std::optional<LabelErrors> ground{};
  std::optional<std::string> dtm_not_compared{};
  std::optional<TerrainErrors> dtm{};
};

template <class V>
void describe(const TruthFindings& r, V& v) {
  v.result("truth", r.truth, core::plain().in_summary(), "Why nothing was compared.");
  v.result("rms_3d", r.rms_3d, core::metres().in_summary().limited_by("truth_rms"), "3D RMS error of the points.");
  v.table("points", r.points, "Errors of the points.");
  v.table("ground", r.ground, "Errors of the ground labels.");
  v.result("dtm", r.dtm_not_compared, core::plain().in_summary(), "Why the terrain model was not compared.");
  v.table("dtm", r.dtm, "Errors of the terrain model.");
}

class Truth : public OptionStage<NoOptions, NoResults, TruthFindings> {
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
      TruthFindings found;
      found.truth = "none: the survey names no truth";
      job.findings = core::reported(found);
      return;
    }
    Sums all;
    for (const TileKey key : job.tiles) {
      const std::string bytes = io::read_text_file(sums_file(job.folder, key));
      Sums s;
      if (bytes.size() != sizeof s) io::cut_short(sums_file(job.folder, key));
      std::memcpy(&s, bytes.data(), sizeof s);
      all.add(s);
    }
    TruthFindings found;
    if (all.n > 0) tell_points(all, found);
    if (context.survey.truth.dtm && context.grids->has(Product::dtm)) tell_terrain(context, job.tiles, found);
    job.findings = core::reported(found);
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

  static void tell_points(const Sums& s, TruthFindings& found) {
    PointErrors& points = found.points.emplace();
    points.compared = static_cast<std::uint64_t>(s.n);
    double square = 0;
    for (size_t a = 0; a < 3; ++a) {
      points.mean[a] = s.sum[a] / s.n;
      points.rms[a] = std::sqrt(s.square[a] / s.n);
      square += s.square[a];
    }
    found.rms_3d = std::sqrt(square / s.n);
    points.largest = s.largest;
    if (s.with_sigma > 0) {
      points.error_over_sigma_h = std::sqrt(s.ratio_h / s.with_sigma);
      points.error_over_sigma_v = std::sqrt(s.ratio_v / s.with_sigma);
    }
    if (s.ground_kept + s.object_taken == 0) return;
    LabelErrors& labels = found.ground.emplace();
    const double ground = s.ground_kept + s.ground_lost, object = s.object_kept + s.object_taken, n = ground + object;
    labels.type_1 = 100 * s.ground_lost / std::max(ground, 1.0);
    labels.type_2 = 100 * s.object_taken / std::max(object, 1.0);
    const double agree = (s.ground_kept + s.object_kept) / n;
    labels.total = 100 * (1 - agree);
    const double chance = ((ground * (s.ground_kept + s.object_taken)) + (object * (s.ground_lost + s.object_kept))) / (n * n);
    labels.kappa = chance < 1 ? 100 * (agree - chance) / (1 - chance) : 100.0;
  }

  static void tell_terrain(const Context& context, const std::vector<TileKey>& tiles, TruthFindings& found) {
    const fs::path file = io::resolve(context.survey, *context.survey.truth.dtm);
    const double cell = context.grids->cell(Product::dtm);
    const io::RasterInfo raster = io::read_raster_info(file);
    if (std::abs(raster.geotransform[1] * context.unit - cell) > 1e-6 * cell) {
      found.dtm_not_compared = "not compared: the truth has another cell";
      return;
    }
    double n = 0, sum = 0, square = 0, with_sigma = 0, ratio = 0, covered = 0;
    std::map<int, std::uint64_t> histogram;  // |error| in mm
    for (const TileKey key : tiles) {
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
    TerrainErrors& dtm = found.dtm.emplace();
    dtm.cells = static_cast<std::uint64_t>(n);
    if (n == 0) return;
    dtm.mean = sum / n;
    dtm.rms = std::sqrt(square / n);
    double seen = 0;
    for (const auto& [mm, count] : histogram) {
      if (seen < 0.5 * n && seen + static_cast<double>(count) >= 0.5 * n) dtm.median_abs = mm / 1000.0;
      if (seen < 0.95 * n && seen + static_cast<double>(count) >= 0.95 * n) dtm.abs_95 = mm / 1000.0;
      seen += static_cast<double>(count);
    }
    if (with_sigma > 0) dtm.error_over_sigma = std::sqrt(ratio / with_sigma);
    dtm.truth_without_height = 100 * (1 - n / covered);
  }
};

}  // namespace

std::unique_ptr<Stage> make_truth() { return std::make_unique<Truth>(); }

}  // namespace swath::stages
