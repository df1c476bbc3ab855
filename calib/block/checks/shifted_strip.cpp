// SPDX-License-Identifier: GPL-3.0-or-later
// Where an image goes does not depend on the image that the shift begins with: from the last image to the first, each trial moves one more,
// and all trials of a strip cost little more than two adjustments of its positions.
#include "calib/block/checks/shifted_strip.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <optional>

#include "calib/block/checks/block_mistakes.h"
#include "calib/block/checks/block_sample.h"
#include "calib/block/checks/moved_residuals.h"
#include "core/error.h"

namespace swath::calib {
namespace {

struct Shift {
  std::vector<std::uint32_t> images;  ///< of the strip
  std::vector<Eigen::Vector3d> places;
  size_t first = 0;
  int step = 1;

  std::vector<std::uint32_t> moved() const { return {images.begin() + static_cast<std::ptrdiff_t>(first), images.end()}; }
};

/// The strips with the largest residuals, some of them.
std::vector<int> worst_strips(const ImageBlock& block, const std::vector<double>& residuals) {
  constexpr size_t tried = 6;
  constexpr double suspicious = 0.02;  // of the principal distance; smaller
  std::map<int, std::pair<double, double>> sums;
  size_t k = 0;
  for (const ImageRay& r : tie_rays(block)) {
    auto& [sum, n] = sums[block.images[r.image].strip];
    sum += std::min(MovedResiduals::at_most, residuals[k++]), n += 1.0;
  }
  std::vector<std::pair<double, int>> order;
  for (const auto& [strip, sum] : sums)
    if (sum.first > suspicious * sum.second) order.emplace_back(-sum.first / sum.second, strip);
  std::sort(order.begin(), order.end());
  std::vector<int> out;
  for (size_t i = 0; i < order.size() && i < tried; ++i) out.push_back(order[i].second);
  return out;
}

/// The shift that leaves the least residuals, less than there are as stated.
std::optional<Shift> best_shift(const ImageBlock& block, MovedResiduals& residuals) {
  std::optional<Shift> best;
  double least = residuals.mean();
  for (const int strip : worst_strips(block, residuals.all()))
    for (const int step : {1, -1}) {
      Shift s{flown(block, strip), {}, 0, step};
      if (s.images.size() < 3) continue;
      s.places = positions_of_next(block, s.images, step);
      bool is_best = false;
      size_t best_first = 0;
      for (size_t k = s.images.size(); k-- > 0;) {
        residuals.move(s.images[k], s.places[k]);
        if (k + 1 == s.images.size() || residuals.mean() >= least) continue;
        is_best = true, best_first = k, least = residuals.mean();
      }
      for (const std::uint32_t i : s.images) residuals.move(i, block.images[i].position);
      if (is_best) s.first = best_first, best = std::move(s);
    }
  return best;
}

}  // namespace

void refuse_shifted_strip(const ReadBlock& read, const BlockConfig& config, double times) {
  constexpr int per_image = 20;  // points
  if (read.stations_observed == 0) return;
  const ReadBlock sample = sample_by_image(read, per_image);
  const ImageBlock& block = sample.block;
  MovedResiduals residuals(block);
  const std::optional<Shift> best = best_shift(block, residuals);
  if (!best) return;
  // Without angles the level start leaves several per cent everywhere: the points of the moved images decide.
  const double before = residuals.mean_on(best->moved());
  for (size_t k = best->first; k < best->images.size(); ++k) residuals.move(best->images[k], best->places[k]);
  const double after = residuals.mean_on(best->moved());
  if (times * after > before) return;
  const BlockImage& first = block.images[best->images[best->first]];
  char text[160];
  std::snprintf(text, sizeof text, ": image points are off by %.1f %% of the principal distance (mean) as stated, by %.1f %% otherwise",
                100.0 * before, 100.0 * after);
  throw core::Error("the stations of strip " + std::to_string(first.strip) + (best->first > 0 ? " from image " + first.name + " on" : "") +
                        " are those of the image " + (best->step > 0 ? "before" : "after") + text,
                    place_of_images(config), match_by_time);
}

}  // namespace swath::calib
