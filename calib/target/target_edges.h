// SPDX-License-Identifier: GPL-3.0-or-later
// One flight line's view of a flat roof: where its edges and its plane appear in the georeferenced returns.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "calib/target/edge_fit.h"
#include "calib/target/target_beams.h"
#include "calib/terms.h"
#include "georef/shot_geometry.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

/// What the analysis knows beforehand.
struct EdgeOptions {
  double search = 10.0;        ///< m: how far the target may appear from its place
  double across = 10.0;        ///< m, sigma of the displacement across the flight: profiles see edges askew and cannot determine it
  double shear = 0.015;        ///< sigma of the turn of the edges that lie across the flight (heading), rad
  double turn = 0.004;         ///< sigma of the turn of the edges that lie along the flight, rad
  double strain_along = 2e-3;  ///< sigma of the target's relative growth along the flight
  double strain_across = 5e-3;
  double range_sigma = 0.02;          ///< m, of one return
  double pointing_sigma = 0.0;        ///< rad: of one beam, without its width
  double beam_divergence = 0.0;       ///< rad, full
  bool several_returns = false;       ///< the scanner records more than one return of a pulse
  double single_growth = 0.25;        ///< single returns: the roof looks larger at each edge by this share of the footprint's diameter ...
  double single_growth_sigma = 0.25;  ///< ... within this
};

/// Where one line sees the target. Flight axes: x along the body's forward axis laid level, y to its right.
struct TargetView {
  bool seen = false;
  std::string why_not;  ///< in words, where it is not seen
  std::uint32_t pulses = 0, on_roof = 0;
  double heading = 0.0;          ///< of the flight axes, from local north, rad
  Eigen::Vector2d centre{0, 0};  ///< east, north: where the displacement holds (surveyed place), m
  Return middle;                 ///< the roof's return nearest to the centre
  double time = 0.0;             ///< of that return, as recorded, s
  std::vector<SideView> sides;   ///< of the target, side k from corner k to corner k + 1

  Eigen::Vector2d displacement{0, 0};                    ///< along, across; computed minus surveyed, m
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< by the returns alone
  Eigen::MatrixXd by_corners;                            ///< 2 x 2n: what east, north of each surveyed corner do to the displacement
  double shear = 0.0, turn = 0.0;                        ///< d along / d y, d across / d x
  double strain_along = 0.0, strain_along_sigma = 0.0, strain_across = 0.0, strain_across_sigma = 0.0;
  double strain_across_by_growth = 0.0;     ///< share of growth's sigma in strain_across: common to all lines
  double growth = 0.0;                      ///< outward at every edge, m
  double height = 0.0, height_sigma = 0.0;  ///< of the roof's returns above the surveyed plane at the centre, m
  double tilt_along = 0.0, tilt_across = 0.0, tilt_along_sigma = 0.0, tilt_across_sigma = 0.0;  ///< upward slope, rise / run
  double roughness = 0.0;       ///< rms of the roof's returns about their plane, m
  double blur = 0.0;            ///< of the edges, sigma in m
  double half_footprint = 0.0;  ///< half the band in which pulses have a return on and one off the roof, m
  double chi2 = 0.0;            ///< of the edges' fit per degree of freedom

  bool all_sides() const;
};

/// The view of one line; its points are computed with `geometry`. Each pulse pierces the roof's plane inside or
/// outside the edges, and has its returns on the roof, off it, or one on each; edges are located by calib/target/edge_fit.h. Where pulses
/// with returns on both levels occur, the edge lies in the middle of their band (walls that face the scanner leave the band's outer end
/// alone); otherwise the footprint's part in it is not known, and a growth of the roof at all its edges is estimated from its size, with
/// the stated one as prior.
TargetView view_target(const TargetPulses& pulses, const ShotGeometry& geometry, const trajectory::Trajectory& trajectory,
                       const RoofTarget& target, const EdgeOptions& options);

}  // namespace swath::calib
