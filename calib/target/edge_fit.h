// SPDX-License-Identifier: GPL-3.0-or-later
// The straight edge of a roof among pulses that fell on it and off it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace swath::calib {

/// Where a pulse pierced the roof's plane, and what came back.
struct EdgePulse {
  float s = 0.0f, t = 0.0f;  ///< outward from and along the expected edge, m
  enum Outcome : std::uint8_t {
    off,      ///< all returns off the roof
    both,     ///< first return on the roof, last one off it
    on,       ///< all returns on the roof
    first_on  ///< first return on the roof; whether a last one lies off it is not known (walls too near behind it)
  } outcome = off;
};

/// One side of a roof as seen by one line.
struct SideView {
  bool used = false;
  double at = 0.0;                                       ///< where along the side the offset holds, from its middle, m
  double offset = 0.0;                                   ///< of the edge from where it was expected, outward, m
  double slope = 0.0;                                    ///< its growth along the side
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of offset and slope, by the pulses alone
  std::uint32_t pulses = 0;                              ///< that contributed
};

/// What is known of an edge before it is looked for.
struct EdgePrior {
  double blur = 0.05;   ///< sigma of a pulse's place across the edge, m
  double half = 0.0;    ///< half the band in which pulses have returns on both levels, m
  double reach = 2.0;   ///< largest offset looked for, m
  double slope = 0.01;  ///< sigma of the slope about zero
};

/// Posterior mean and covariance of offset and slope by quadrature, for the model
///   P(all on) = N((e - s - half) / blur),  P(first on) = N((e - s + half) / blur),  e = offset + slope (t - at),
/// N the normal distribution; one pulse in a hundred may say anything. No spacing of the pulses is assumed: where they leave a gap at the
/// edge, the posterior is flat over it and sigma says so. Not used: fewer than five pulses on either side, or mass at the end of the reach.
SideView locate_edge(const std::vector<EdgePulse>& pulses, const EdgePrior& prior);

/// Most likely blur and half band, with the edge at s = 0 in all pulses (none of them `first_on`). `blur`: the one expected, within a
/// factor of two or so; `half` is looked for up to `widest` (0: none).
struct EdgeShape {
  double blur, half;
};
EdgeShape edge_shape(const std::vector<EdgePulse>& pulses, double blur, double widest);

}  // namespace swath::calib
