// SPDX-License-Identifier: GPL-3.0-or-later
// The points' random errors out of a TIN's heights, breaks kept.
#pragma once

#include <vector>

#include "terrain/tin.h"

namespace swath::terrain {

/// Every vertex takes the mean of the heights that the planes around it and around its neighbours in the triangulation within `radius` (m)
/// foretell, the most from planes that fit their points. Vertices of constraints (row `points` and more) keep their height, and so do those
/// on the border, those with an edge longer than twice the radius and those with fewer than four neighbours within it, or all on one line.
/// Returns, per vertex, the share of its random error's variance that is left: 1 where the height was kept.
/// The heights of a triangle depend on the triangles within smoothing_reach() of any place in it, and on nothing else.
std::vector<float> smooth_heights(Tin& tin, size_t points, double radius);

/// m
double smoothing_reach(double radius);

}  // namespace swath::terrain
