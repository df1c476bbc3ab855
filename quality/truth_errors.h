// SPDX-License-Identifier: GPL-3.0-or-later
// Points and terrain against the truth of a simulated survey.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "core/block.h"
#include "core/config/result.h"
#include "core/grid.h"

namespace swath::quality {

/// Sums of errors: plain numbers, so that tiles add up in any order of work but one order of adding.
struct TruthSums {
  double n = 0, sum[3] = {}, square[3] = {}, ratio_h = 0, ratio_v = 0, with_sigma = 0, largest = 0;
  double ground_kept = 0, ground_lost = 0, object_kept = 0, object_taken = 0;
  double water_kept = 0, water_taken = 0, called_water = 0;  ///< true water that is not and is called ground; points called water

  /// Point `i` against its true place (map metres) and class. Outliers count in the labels, not in the errors: they are wrong by what makes
  /// them outliers.
  void add(const core::Block& block, size_t i, const Eigen::Vector3d& place, int true_class);
  void add(const TruthSums& o);
};

using Figure = std::optional<double>;

struct PointErrors {
  std::uint64_t compared = 0;
  std::array<double, 3> mean{}, rms{};
  double largest = 0.0, rms_3d = 0.0;  ///< m
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
  std::uint64_t water_left_out = 0;
};

template <class V>
void describe(const LabelErrors& r, V& v) {
  using core::percent;
  v.result("type_1_percent", r.type_1, percent(2).in_summary(), "Ground returns that were rejected.");
  v.result("type_2_percent", r.type_2, percent(2).in_summary(), "Other returns that were accepted as ground.");
  v.result("total_error_percent", r.total, percent(2).in_summary(), "Returns with the wrong label.");
  v.result("kappa_percent", r.kappa, percent(2).in_summary(), "Cohen's kappa.");
  v.result("water_left_out", r.water_left_out, core::if_any(), "Returns on water, left out where no return is classified as water.");
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

/// What the sums say; there is nothing where no point was compared, or no label.
std::optional<PointErrors> point_errors(const TruthSums& s);
std::optional<LabelErrors> label_errors(const TruthSums& s);

/// Errors of a terrain model, tile by tile.
class TerrainSums {
 public:
  /// `metres`: per unit of the truth's heights. Both on one lattice.
  void add(const core::Grid& model, const core::Grid& truth, double metres);
  TerrainErrors errors() const;

 private:
  double n_ = 0, sum_ = 0, square_ = 0, with_sigma_ = 0, ratio_ = 0, covered_ = 0;
  std::map<int, std::uint64_t> histogram_;  // |error| in mm
};

}  // namespace swath::quality
