// SPDX-License-Identifier: GPL-3.0-or-later
// Surveyed points against the ground points around them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/block.h"
#include "core/config/option.h"

namespace swath::quality {

/// A surveyed point on the ground; map metres.
struct CheckMark {
  std::string name, cover, place;  ///< place: "file:line"
  Eigen::Vector3d at;
  double sigma = 0.0;  ///< m, of its height
};

/// The ground less a mark's height, by the points of one line around it; plain data.
struct MarkReading {
  std::int32_t mark = 0, line = 0;
  std::uint32_t points = 0;
  float difference = 0.0F;  ///< m
  float sigma = 0.0F;       ///< m, median of the points' own; 0 where they have none
  float slope = 0.0F;       ///< rise / run of the plane through them; 0 where their mean is taken
  float scatter = 0.0F;     ///< m, rms of the points about the plane or the mean: plants that passed as ground show in it
  float sigma_h = 0.0F;     ///< m, median of the points' own sigma of place, radial; 0 where they have none
};

enum class MarkSurface {
  plane,  ///< at four points or more on all sides the plane through them at the mark, otherwise their mean
  mean,   ///< their mean
};

/// Readings of the marks `here` (indices of `marks`), one of each line that has points of class ground within `radius` m.
std::vector<MarkReading> read_marks(const core::Block& block, const std::vector<CheckMark>& marks, const std::vector<std::size_t>& here,
                                    double radius, MarkSurface surface = MarkSurface::plane);

}  // namespace swath::quality

namespace swath::core {
template <>
struct Choices<quality::MarkSurface> {
  static constexpr std::array<std::string_view, 2> names{"plane", "mean"};
};
}  // namespace swath::core
