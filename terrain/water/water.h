// SPDX-License-Identifier: GPL-3.0-or-later
// Heights of lakes and rivers: their own, or from the ground points along their shores.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/block.h"
#include "core/breakline.h"
#include "core/config/option.h"
#include "core/report.h"

namespace swath::terrain {

struct WaterOptions {
  core::Metres shore{2.0};
  double quantile = 0.1;
  core::Metres stretch{50.0};
};

template <class V>
void describe(WaterOptions& o, V& v) {
  v.option("shore", o.shore, core::above(0.0),
           "Water without heights: width of the strip of ground points outside its line that gives them.");
  v.option("quantile", o.quantile, core::within(0.0, 0.5),
           "Water without heights: the share of shore points below its level; low, as banks rise from the water.");
  v.option("stretch", o.stretch, core::above(0.0), "Rivers without heights: length of the stretch whose shore points give a level.");
}

/// A ground point at a shore.
struct ShorePoint {
  std::uint32_t feature = 0;  ///< index of the water among the features
  std::uint32_t vertex = 0;   ///< nearest vertex of its sampled outer ring
  double z = 0.0;             ///< m
  float sigma = 0.0f;         ///< m
};

/// Points of `rows` below `own` that stand outside a water without heights and within `shore` of a vertex of its outer ring, sampled at
/// half of `shore`. Features in the Block's frame.
std::vector<ShorePoint> shore_points(const core::Block& block, const std::vector<std::uint32_t>& rows, size_t own,
                                     const std::vector<core::Breakline>& features, const WaterOptions& options);

/// The water with the heights of its surface at every vertex of its rings: lakes flat, rivers falling from one end to the other.
/// Own heights: a lake takes their median, a river its own vertices, repaired where they rise (each bank by itself). From shore points:
/// a lake their `quantile`; a river that of each stretch, level from bank to bank, monotone by least squares. The rings of a river come
/// back sampled. Without heights and shore points has_height stays false. Anomalies go to the tally.
core::Breakline with_heights(const core::Breakline& water, std::vector<ShorePoint> shores, const WaterOptions& options, core::Tally& tally);

}  // namespace swath::terrain
