// SPDX-License-Identifier: GPL-3.0-or-later
// Planimetry of a cloud by the edges of surveyed roofs.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/block.h"
#include "core/config/result.h"

namespace swath::quality {

/// A surveyed roof, or another plane that ends in the air on all or most sides; map metres.
struct RoofTarget {
  std::string name;
  std::vector<Eigen::Vector3d> corners;  ///< around it, in either direction
  double sigma = 0.0;                    ///< m, of each horizontal coordinate of a corner
};

/// A return near an edge; plain data. Edge k of a target goes from its corner k to the next.
struct EdgeReturn {
  std::int32_t target = 0, edge = 0;
  float out = 0.0F;    ///< m beyond the edge as surveyed; negative: over the roof
  float above = 0.0F;  ///< m above the target's plane
};

/// Those of the first `own` points, in no order that matters.
std::vector<EdgeReturn> edge_returns(const core::Block& block, std::size_t own, const std::vector<RoofTarget>& targets);

/// Where the cloud has a roof, less where it was surveyed.
struct RoofShift {
  std::string name;
  std::size_t edges = 0, returns = 0;  ///< that were used
  double east = 0.0, north = 0.0;      ///< m
  double sigma_east = 0.0, sigma_north = 0.0;
  double wider = 0.0;   ///< m by which every edge lies farther out: the beam's width, gutters
  double misfit = 0.0;  ///< m, rms of the edges about shift and width; 0 where there are three
};

template <class V>
void describe(const RoofShift& r, V& v) {
  using core::metres;
  v.result("name", r.name, "Name of the target.");
  v.result("edges", r.edges, "Its edges that the cloud shows.");
  v.result("returns", r.returns, "Returns of the roof near them.");
  v.result("east_m", r.east, metres(4), "Roof of the cloud less target, east.");
  v.result("north_m", r.north, metres(4), "The same, north.");
  v.result("sigma_east_m", r.sigma_east, metres(4), "Its sigma by the returns at the edges, without that of the target.");
  v.result("sigma_north_m", r.sigma_north, metres(4), "The same, north.");
  v.result("wider_m", r.wider, metres(4), "By which every edge lies farther out than surveyed: the beam's width, gutters.");
  v.result("misfit_m", r.misfit, metres(4), "Rms of the edges about shift and width; 0: three edges.");
}

/// Of the targets with three edges that the cloud shows, in two directions. An edge is shown where there are returns enough over the roof
/// and where beyond it nothing as high goes on (ridges, neighbours).
std::vector<RoofShift> roof_shifts(const std::vector<RoofTarget>& targets, const std::vector<EdgeReturn>& returns);

struct RoofPlanimetry {
  std::size_t roofs = 0;
  double east = 0.0, north = 0.0;              ///< m, mean shift, weighted
  double sigma_east = 0.0, sigma_north = 0.0;  ///< m, of the mean
  double rmse_east = 0.0, rmse_north = 0.0, rmse = 0.0, with_targets = 0.0;
};

template <class V>
void describe(const RoofPlanimetry& r, V& v) {
  using core::metres;
  v.result("roofs", r.roofs, "Targets whose edges were compared.");
  v.result("east_m", r.east, metres(4), "Mean shift of the cloud, east; weighted.");
  v.result("north_m", r.north, metres(4), "The same, north.");
  v.result("sigma_east_m", r.sigma_east, metres(4), "Sigma of the mean, that of the targets with it.");
  v.result("sigma_north_m", r.sigma_north, metres(4), "The same, north.");
  v.result("rmse_east_m", r.rmse_east, metres(4), "RMSE of the roofs' shifts, east.");
  v.result("rmse_north_m", r.rmse_north, metres(4), "The same, north.");
  v.result("rmse_m", r.rmse, metres(4), "Horizontal RMSE, radial: root of the sum of both squares.");
  v.result("rmse_with_targets_m", r.with_targets, metres(4), "The same with the targets' own error added (ASPRS 2024).");
}

/// Throws nothing for none: all zero.
RoofPlanimetry planimetry_of(const std::vector<RoofTarget>& targets, const std::vector<RoofShift>& shifts);

}  // namespace swath::quality
