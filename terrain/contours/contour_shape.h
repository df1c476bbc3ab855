// SPDX-License-Identifier: GPL-3.0-or-later
// Contour lines of one level thinned within a vertical tolerance, so that no line crosses another or itself.
#pragma once

#include <vector>

#include "terrain/contours/contour_line.h"
#include "terrain/contours/facets.h"

namespace swath::terrain {

/// Thins all lines of one level, given as traced (contour_lines.h). Afterwards
/// - `surface` lies within `tolerance` (m) of the line's height along every segment that is new, not only at its vertices, so lines of
///   levels more than twice the tolerance apart cannot meet;
/// - no two segments of the level meet but neighbours at their vertex: what is new keeps 1e-5 of a cell from all else;
/// - no line was drawn across a node of the surface that lies outside the tolerance, nor across another line: the order of the lines and
///   what they enclose is as traced.
/// Ends of open lines stay. The outcome depends on the lines and the surface alone. Tolerance 0 leaves everything as it is.
void thin(std::vector<ContourLine>& lines, Facets& surface, double tolerance);

}  // namespace swath::terrain
