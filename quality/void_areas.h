// SPDX-License-Identifier: GPL-3.0-or-later
// The voids of all tiles as areas with their outlines, within what the survey covers.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/area.h"
#include "core/config/option.h"
#include "core/config/result.h"
#include "quality/void_cells.h"
#include "quality/void_rims.h"

namespace swath::quality {

/// A cell of a survey's footprint, 64 cells of void_cell() a side, that holds a first return; plain data.
struct FootprintCell {
  std::int32_t i = 0, j = 0;
  auto operator<=>(const FootprintCell&) const = default;
};
inline double footprint_cell(const PulseSpacing& s) { return 64.0 * void_cell(s); }

/// Of the first `own` points.
std::vector<FootprintCell> footprint_of(const core::Block& block, std::size_t own, const PulseSpacing& spacing);

/// Why a void counts as water.
enum class WaterBy { none, known, points, shore };

}  // namespace swath::quality

template <>
struct swath::core::Choices<swath::quality::WaterBy> {
  static constexpr std::array<std::string_view, 4> names{"none", "known", "points", "shore"};
};

namespace swath::quality {

struct VoidArea {
  double x = 0.0, y = 0.0;  ///< of its middle, m
  double area = 0.0;        ///< m2
  WaterBy water = WaterBy::none;
  bool is_water() const { return water != WaterBy::none; }
  std::string evidence() const;                       ///< "known", "points", "shore"; empty where it is none
  std::vector<std::vector<Eigen::Vector2d>> rings{};  ///< outline with the void to the left, then its islands; m, not closed
};

template <class V>
void describe(const VoidArea& r, V& v) {
  v.result("x", r.x, "Easting of its middle, m.");
  v.result("y", r.y, "Northing of its middle, m.");
  v.result("area_m2", r.area, "Its area.");
  v.result("water", r.is_water(), "Whether it is water.");
  v.result("water_by", r.evidence(), core::plain().only_if(r.is_water()),
           "Why it is water: known (breaklines), points (class 9 on its rim), shore (a level rim below the ground around).");
}

struct SwathVoids {
  double judged = 0.0;                  ///< m2, within the footprint
  double least = 0.0;                   ///< m2: smaller ones are none
  double area = 0.0, water_area = 0.0;  ///< m2, of all voids; apart from water, and of water
  std::vector<VoidArea> voids{};        ///< largest first
};

/// Joins the runs of all tiles. Judged is what the survey covers: footprint cells and gaps between them up to `max_gap` m wide, and what
/// they enclose, without the outermost cells, for nothing shows how far these are covered.
/// `without_points`: squares that no tile has looked at; what of them the survey covers is void. `rims`: of all tiles; none: no void is
/// water by its shore.
SwathVoids judge_voids(std::vector<VoidRun> runs, const std::vector<FootprintCell>& footprint, const std::vector<core::Box>& without_points,
                       const PulseSpacing& spacing, double max_gap, const std::vector<RimPiece>& rims = {});

}  // namespace swath::quality
