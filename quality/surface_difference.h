// SPDX-License-Identifier: GPL-3.0-or-later
// A terrain model less a reference, by slope and by what covers the ground.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/block.h"
#include "core/grid.h"
#include "quality/binned_errors.h"

namespace swath::quality {

/// What covers a cell of the terrain model, by the classes of its returns.
enum class GroundCover : std::uint8_t {
  open,        ///< ground returns, and few others
  vegetation,  ///< 30 % of the returns or more are vegetation, or of no class
  building,    ///< 30 % or more are roofs
  unseen,      ///< no ground return: the model spans it
};
constexpr std::array<std::string_view, 4> cover_names{"open", "vegetation", "building", "no ground return"};

/// Of every cell of `window`. Needs classification and flags.
std::vector<GroundCover> covers_of(const core::Block& block, const core::Lattice& window);

/// Slope classes: up to 5, 10, 20, 30 deg, and steeper.
constexpr std::array<double, 4> slope_borders{5.0, 10.0, 20.0, 30.0};
std::string slope_name(int slope_class);
int slope_class_of(double degrees);

/// Differences of one slope class and cover in one tile; plain data.
struct DifferenceSums {
  std::int32_t slope = 0, cover = 0;
  ErrorSums sums{};
};
struct DifferenceBin {
  std::int32_t slope = 0, cover = 0, bin = 0;
  std::uint32_t cells = 0;
};

struct SurfaceDifference {
  core::Grid difference;  ///< height: model less reference, m
  std::vector<DifferenceSums> sums{};
  std::vector<DifferenceBin> bins{};
  std::uint64_t not_compared = 0;  ///< cells with a height where the reference has none
};

/// `reference`: height at a place of the map, NaN where it has none. `slope`: degrees, on the model's lattice.
SurfaceDifference compare_surface(const core::Grid& model, const core::Grid& slope, const std::vector<GroundCover>& covers,
                                  const std::function<double(double, double)>& reference);

struct SurfaceClass {
  std::string slope, cover;  ///< "all": of every kind
  BinnedStatistics errors{};
};

template <class V>
void describe(const SurfaceClass& r, V& v) {
  v.result("slope", r.slope, "Slope class, degrees; all: every slope.");
  v.result("cover", r.cover, "open, vegetation, building, no ground return, or all.");
  describe(r.errors, v);
}

struct SurfaceComparison {
  std::vector<SurfaceClass> classes{};      ///< all; each cover; each slope; each slope of open ground
  std::vector<double> bins{}, bin_cells{};  ///< of all differences: middles of 41 bins within three times their 95 %, m, and how many
};
SurfaceComparison judge_surface(const std::vector<DifferenceSums>& sums, const std::vector<DifferenceBin>& bins);

}  // namespace swath::quality
