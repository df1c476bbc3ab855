// SPDX-License-Identifier: GPL-3.0-or-later
// Two ways to the places of the same events, side by side.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "core/records/event_data.h"
#include "trajectory/event_positions.h"

namespace swath::trajectory {

/// First less second, east, north, height, m.
struct PlaceDifferences {
  std::string techniques;
  size_t pairs = 0, only_first = 0, only_second = 0;
  Eigen::Vector3d bias = Eigen::Vector3d::Zero(), rms = bias, standard = bias, largest = bias;
  std::optional<Eigen::Vector3d> ratio{};  ///< rms of difference / sigma, where the two are independent
};

template <class V>
void describe(const PlaceDifferences& r, V& v) {
  const auto known = core::metres(4).only_if(r.pairs > 0);
  v.result("techniques", r.techniques, "Names of the two.");
  v.result("pairs", r.pairs, "Events that both have with a position.");
  v.result("only_first", r.only_first, "Events of the first alone.");
  v.result("only_second", r.only_second, "Events of the second alone.");
  v.result("bias_m", r.bias, known, "Mean difference: east, north, height.");
  v.result("rms_m", r.rms, known, "RMS difference.");
  v.result("standard_deviation_m", r.standard, core::metres(4).only_if(r.pairs > 1), "Standard deviation about the mean.");
  v.result("largest_m", r.largest, known, "Largest difference.");
  v.result("difference_over_sigma", r.ratio, core::plain(2), "RMS of difference over its sigma.");
}

/// Each technique against the first, events paired by name (names that repeat: in their order); and each technique that has places of its
/// recorder's own against those. Positions of two techniques come from the same fixes and have no ratio.
std::vector<PlaceDifferences> compare_event_places(const core::EventData& events, const std::vector<EventPosition>& solved);

}  // namespace swath::trajectory
