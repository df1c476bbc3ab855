// SPDX-License-Identifier: GPL-3.0-or-later
// The points' random errors out of a TIN's heights, breaks kept.
#pragma once

#include <vector>

#include "terrain/tin/rectangle.h"
#include "terrain/tin/tin.h"

namespace swath::terrain {

struct Smoothed {
  std::vector<float> left;     ///< per vertex, share of its random error's variance that is left: 1 where the height was kept
  std::vector<float> scatter;  ///< m^2, per vertex: variance of the heights as they came about the surface, of it and the two rings around
                               ///< it; NaN where the height was kept
};

/// Every vertex takes the mean of the heights that the planes around it and around its neighbours in the triangulation within `radius` (m)
/// foretell, the most from planes that fit their points. Vertices of constraints (row `points` and more) keep their height, and so do those
/// on the border, those with an edge longer than twice the radius and those with fewer than four neighbours within it, or all on one line.
/// The heights of a triangle and the scatter about it depend on the triangles within smoothing_reach() of any place in it, and on
/// nothing else. Only triangles that touch `where` count: beyond it vertices may keep their height.
Smoothed smooth_heights(Tin& tin, size_t points, double radius, const Rectangle& where = {});

/// m
double smoothing_reach(double radius);

}  // namespace swath::terrain
