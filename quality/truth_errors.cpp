// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/truth_errors.h"

#include <algorithm>
#include <cmath>

namespace swath::quality {

void TruthSums::add(const core::Block& block, size_t i, const Eigen::Vector3d& place, int true_class) {
  const std::array<double, 3> e = {block.origin.x() + block.x[i] - place.x(), block.origin.y() + block.y[i] - place.y(),
                                   block.origin.z() + block.z[i] - place.z()};
  if (true_class != core::point_class::low_noise && true_class != core::point_class::high_noise) {
    ++n;
    for (size_t a = 0; a < 3; ++a) sum[a] += e[a], square[a] += e[a] * e[a];
    largest = std::max(largest, std::hypot(e[0], e[1], e[2]));
    if (!block.sigma_h.empty() && block.sigma_h[i] > 0 && block.sigma_v[i] > 0) {
      const auto h = static_cast<double>(block.sigma_h[i]), v = static_cast<double>(block.sigma_v[i]);
      ratio_h += (e[0] * e[0] + e[1] * e[1]) / (h * h);
      ratio_v += e[2] * e[2] / (v * v);
      ++with_sigma;
    }
  }
  if (block.classification.empty()) return;
  if (block.classification[i] == core::point_class::water) ++called_water;
  const bool is_ground = true_class == core::point_class::ground, is_called = block.classification[i] == core::point_class::ground;
  if (true_class == core::point_class::water) {
    ++(is_called ? water_taken : water_kept);
    return;
  }
  ++(is_ground ? (is_called ? ground_kept : ground_lost) : (is_called ? object_taken : object_kept));
}

void TruthSums::add(const TruthSums& o) {
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
  water_kept += o.water_kept;
  water_taken += o.water_taken;
  called_water += o.called_water;
}

std::optional<PointErrors> point_errors(const TruthSums& s) {
  if (s.n == 0) return std::nullopt;
  PointErrors out;
  out.compared = static_cast<std::uint64_t>(s.n);
  double square = 0;
  for (size_t a = 0; a < 3; ++a) {
    out.mean[a] = s.sum[a] / s.n;
    out.rms[a] = std::sqrt(s.square[a] / s.n);
    square += s.square[a];
  }
  out.rms_3d = std::sqrt(square / s.n);
  out.largest = s.largest;
  if (s.with_sigma > 0) {
    out.error_over_sigma_h = std::sqrt(s.ratio_h / s.with_sigma);
    out.error_over_sigma_v = std::sqrt(s.ratio_v / s.with_sigma);
  }
  return out;
}

std::optional<LabelErrors> label_errors(const TruthSums& s) {
  if (s.n == 0 || s.ground_kept + s.object_taken + s.water_taken == 0) return std::nullopt;
  LabelErrors out;
  // Without a stage that finds water, its surface is the ground that a filter is to find.
  const bool has_water = s.called_water > 0;
  if (!has_water) out.water_left_out = static_cast<std::uint64_t>(s.water_kept + s.water_taken);
  const double kept = s.object_kept + (has_water ? s.water_kept : 0.0), taken = s.object_taken + (has_water ? s.water_taken : 0.0);
  const double ground = s.ground_kept + s.ground_lost, object = kept + taken, n = ground + object;
  if (n == 0) return std::nullopt;
  out.type_1 = 100 * s.ground_lost / std::max(ground, 1.0);
  out.type_2 = 100 * taken / std::max(object, 1.0);
  const double agree = (s.ground_kept + kept) / n;
  out.total = 100 * (1 - agree);
  const double chance = ((ground * (s.ground_kept + taken)) + (object * (s.ground_lost + kept))) / (n * n);
  out.kappa = chance < 1 ? 100 * (agree - chance) / (1 - chance) : 100.0;
  return out;
}

void TerrainSums::add(const core::Grid& model, const core::Grid& truth, double metres) {
  for (size_t k = 0; k < model.lattice.size(); ++k) {
    if (truth.reason[k] != core::Void::none) continue;
    ++covered_;
    if (model.reason[k] != core::Void::none) continue;
    const double e = static_cast<double>(model.height[k]) - static_cast<double>(truth.height[k]) * metres;
    ++n_;
    sum_ += e;
    square_ += e * e;
    ++histogram_[static_cast<int>(std::min(1e8, std::abs(e) * 1000))];
    if (!model.sigma.empty() && model.sigma[k] > 0)
      ratio_ += e * e / (static_cast<double>(model.sigma[k]) * static_cast<double>(model.sigma[k])), ++with_sigma_;
  }
}

TerrainErrors TerrainSums::errors() const {
  TerrainErrors out;
  out.cells = static_cast<std::uint64_t>(n_);
  if (n_ == 0) return out;
  out.mean = sum_ / n_;
  out.rms = std::sqrt(square_ / n_);
  double seen = 0;
  for (const auto& [mm, count] : histogram_) {
    if (seen < 0.5 * n_ && seen + static_cast<double>(count) >= 0.5 * n_) out.median_abs = mm / 1000.0;
    if (seen < 0.95 * n_ && seen + static_cast<double>(count) >= 0.95 * n_) out.abs_95 = mm / 1000.0;
    seen += static_cast<double>(count);
  }
  if (with_sigma_ > 0) out.error_over_sigma = std::sqrt(ratio_ / with_sigma_);
  out.truth_without_height = 100 * (1 - n_ / covered_);
  return out;
}

}  // namespace swath::quality
