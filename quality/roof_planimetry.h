// SPDX-License-Identifier: GPL-3.0-or-later
// Planimetry of a cloud by the shifts of its roofs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "quality/mark_faults.h"
#include "quality/roof_edges.h"

namespace swath::quality {

constexpr std::uint64_t enough_roofs = 30;  ///< check points that ASPRS 2024 wants for a statement
constexpr std::uint64_t fewest_roofs = 3;   ///< by fewer no RMSE is given

/// Cloud less targets; m.
struct RoofPlanimetry {
  std::uint64_t roofs = 0, one_component = 0, few_edges = 0, not_there = 0, changed = 0;
  std::optional<double> east{}, north{}, sigma_east{}, sigma_north{};  ///< mean shift; none where the roofs show one component alone
  std::optional<double> along{}, sigma_along{}, azimuth{};             ///< then that component; deg from north
  double between = 0.0;                                                ///< sigma of a roof's shift about the mean, of one axis
  std::optional<double> rmse_east{}, rmse_north{}, rmse{};
  double measured_sigma = 0.0, target_sigma = 0.0;  ///< of a roof's place, radial, rms: by the pulses; of the targets
  double cloud = 0.0;                               ///< RMSE with both taken off; negative: they explain more
  std::optional<double> with_targets{}, nssda{};
  bool is_enough = false;
};

template <class V>
void describe(const RoofPlanimetry& r, V& v) {
  using core::if_any;
  using core::metres;
  const bool judged = r.rmse.has_value();
  v.result("roofs", r.roofs, "Targets whose shift is known in both components.");
  v.result("one_component", r.one_component, if_any(), "Targets that show one component alone: they count in the mean, not in the RMSE.");
  v.result("few_edges", r.few_edges, if_any(), "Targets with too few edges that end in the air, or too few pulses at them.");
  v.result("not_there", r.not_there, if_any(), "Targets without returns in their plane.");
  v.result("changed", r.changed, if_any(), "Targets that contradict themselves or the others: left out, and named.");
  v.result("east_m", r.east, metres(4).in_summary(), "Mean shift of the cloud, east; weighted.");
  v.result("north_m", r.north, metres(4).in_summary(), "The same, north.");
  v.result("sigma_east_m", r.sigma_east, metres(4), "Its sigma, that of the targets and the scatter between roofs with it.");
  v.result("sigma_north_m", r.sigma_north, metres(4), "The same, north.");
  v.result("azimuth_deg", r.azimuth, "Direction of the one component that all roofs show, deg from north.");
  v.result("along_m", r.along, metres(4), "Mean shift in that direction.");
  v.result("sigma_along_m", r.sigma_along, metres(4), "Its sigma.");
  v.result("between_m", r.between, metres(4), "Sigma of one axis by which roofs differ more than their own sigmas say.");
  v.result("rmse_east_m", r.rmse_east, metres(4), "RMSE of the roofs' shifts, east.");
  v.result("rmse_north_m", r.rmse_north, metres(4), "The same, north.");
  v.result("rmse_m", r.rmse, metres(4), "Horizontal RMSE, radial: root of the sum of both squares.");
  v.result("measured_sigma_m", r.measured_sigma, metres(4).only_if(judged), "What the pulses' spacing adds to it: sigma, radial, rms.");
  v.result("sigma_of_targets_m", r.target_sigma, metres(4).only_if(judged), "Sigma of the targets' places, radial, rms.");
  v.result("cloud_m", r.cloud, metres(4).only_if(judged), "RMSE with both taken off; negative: they explain more than there is.");
  v.result("rmse_with_targets_m", r.with_targets, metres(4).in_summary().limited_by("planimetry"),
           "RMSE_H: the radial RMSE with the targets' own error added (ASPRS 2024).");
  v.result("nssda_m", r.nssda, metres(4), "95 % of horizontal errors are smaller, by the NSSDA (1998) from the same.");
  v.result("is_enough", r.is_enough, "There are 30 roofs or more: fewer make no statement of accuracy.");
}

/// Takes out roofs that contradict the others (their state becomes `disagrees`) and adds their names to `named`.
RoofPlanimetry planimetry_of(std::vector<RoofShift>& shifts, std::vector<NamedFault>& named);

}  // namespace swath::quality
