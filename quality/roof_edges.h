// SPDX-License-Identifier: GPL-3.0-or-later
// Where a cloud has surveyed roofs, by their edges.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "quality/roof_returns.h"

namespace swath::quality {

/// What a roof shows of the cloud's shift.
enum class RoofState {
  both,       ///< both components
  one,        ///< one component: edges of one direction, or of two without their opposites
  few_edges,  ///< nothing: too few edges, or none sharp enough
  not_there,  ///< nothing: no returns in the roof's plane, or gaps in it
  disagrees,  ///< nothing: its edges contradict one another or all lie elsewhere, it was changed or surveyed wrongly
};

}  // namespace swath::quality

namespace swath::core {
template <>
struct Choices<quality::RoofState> {
  static constexpr std::array<std::string_view, 5> names{"both", "one", "few_edges", "not_there", "disagrees"};
};
}  // namespace swath::core

namespace swath::quality {

constexpr double widest_rim = 0.5;  ///< m by which all edges may lie farther out or in: more is another roof

/// The direction that an information is largest in, as a unit vector between north and south by the east.
Eigen::Vector2d best_direction(const Eigen::Matrix2d& information);
/// deg from north, 0 to 180 for such a direction.
double azimuth_of(const Eigen::Vector2d& direction);

/// Where the cloud has a roof, less where it was surveyed; m.
struct RoofShift {
  std::string name;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();  ///< on the map
  RoofState state = RoofState::few_edges;
  std::size_t edges = 0, pulses = 0;  ///< that were used
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();  ///< of the shift, 1/m2; of rank one where one component is known
  double target_sigma = 0.0;                              ///< of the surveyed roof's place along one axis, rms; the information has it, too
  double wider = 0.0;                                     ///< by which every edge lies farther out
  double misfit = 0.0;                                    ///< rms of the edges about shift and width; 0 where there is none to spare

  bool is_known() const { return state == RoofState::both || state == RoofState::one; }
  std::optional<double> of_axis(int axis) const;  ///< shift east (0) or north (1), where it is known
  std::optional<double> sigma(int axis) const;    ///< of it
  Eigen::Vector2d direction() const { return best_direction(information); }
};

template <class V>
void describe(const RoofShift& r, V& v) {
  using core::metres;
  const bool one = r.state == RoofState::one;
  v.result("name", r.name, "Name of the target.");
  v.result("state", std::string(core::Choices<RoofState>::names[static_cast<std::size_t>(r.state)]),
           "both: east and north are known; one: one component; few_edges, not_there, disagrees: nothing.");
  v.result("x", r.middle.x(), metres(2), "Easting of its middle, as surveyed.");
  v.result("y", r.middle.y(), metres(2), "Northing of its middle.");
  v.result("edges", r.edges, "Its edges that the cloud shows.");
  v.result("pulses", r.pulses, "Pulses near them.");
  v.result("east_m", r.of_axis(0), metres(4), "Roof of the cloud less target, east.");
  v.result("north_m", r.of_axis(1), metres(4), "The same, north.");
  v.result("sigma_east_m", r.sigma(0), metres(4), "Sigma by the pulses at the edges and by the target's corners.");
  v.result("sigma_north_m", r.sigma(1), metres(4), "The same, north.");
  v.result("azimuth_deg", azimuth_of(r.direction()), core::plain().only_if(one),
           "Direction of the component that is known, deg from north.");
  v.result("along_m", r.direction().dot(r.shift), metres(4).only_if(one), "Roof of the cloud less target in that direction.");
  v.result("sigma_along_m", 1.0 / std::sqrt(r.information.trace()), metres(4).only_if(one), "Its sigma.");
  v.result("target_sigma_m", r.target_sigma, metres(4).only_if(r.is_known()), "The target's part of a sigma.");
  v.result("wider_m", r.wider, metres(4).only_if(r.state == RoofState::both),
           "By which every edge lies farther out: the beam's width, gutters.");
  v.result("misfit_m", r.misfit, metres(4).only_if(r.is_known()), "Rms of the edges about shift and width; 0: none to spare.");
}

/// One for each target, in their order. `returns`: of returns_at_roofs(), in any order. `run_sigmas`: of find_runs(); empty: the beams are
/// known.
std::vector<RoofShift> roof_shifts(const std::vector<RoofTarget>& targets, const std::vector<RoofReturn>& returns,
                                   const std::vector<double>& run_sigmas = {});

}  // namespace swath::quality
