// SPDX-License-Identifier: GPL-3.0-or-later
// Direct orientation beside the integrated one: by the trajectory alone, and after the adjustment.
#pragma once

#include <string>
#include <vector>

#include "calib/block/block_adjust.h"
#include "calib/block/block_reading.h"
#include "core/config/result.h"

namespace swath::calib {

/// One component over all images: position on the grid, m; rotation about the camera's axes, deg.
struct DirectCompared {
  std::string component, unit;
  double direct = 0.0, integrated = 0.0;           ///< medians of the standard deviations
  double mean = 0.0, rms = 0.0, over_sigma = 0.0;  ///< of integrated less direct
  bool is_known = true;                            ///< false: the boresight, or the lever arm, is free: direct orientation has no sigma
  bool is_tested = true;                           ///< false: no sigma, stations or attitudes took no part, or datum or drift moved them
};
template <class V>
void describe(const DirectCompared& r, V& v) {
  v.result("component", r.component, "Component: east, north, up of the perspective centre; tilt about the image's x and y axis; turn.");
  v.result("unit", r.unit, "Its unit.");
  v.result("direct_sigma", r.direct, core::plain().only_if(r.is_known), "Median standard deviation of direct orientation.");
  v.result("integrated_sigma", r.integrated, "The same after the adjustment.");
  v.result("mean", r.mean, "Mean of integrated less direct.");
  v.result("rms", r.rms, "Root mean square of that.");
  v.result("rms_over_sigma", r.over_sigma, core::plain(2).only_if(r.is_tested),
           "Root mean square of the differences over their own standard deviations: near 1 where trajectory and images agree.");
}

/// `stated`: before the adjustment, with start values by stations and angles and with their covariances. Empty where it has none.
std::vector<DirectCompared> compare_direct(const ReadBlock& stated, const ReadBlock& adjusted, const BlockSolution& solution);

}  // namespace swath::calib
