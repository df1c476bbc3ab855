// SPDX-License-Identifier: GPL-3.0-or-later
// Returns taken for a support that wires run on past: a tree or a bush whose top comes near them.
#pragma once

#include <vector>

#include "terrain/corridor/strands.h"
#include "terrain/corridor/supports.h"

namespace swath::terrain {

/// Of each group whether it carries nothing: of the wires on both sides of it more than half run on as one curve, without the break in
/// slope that a support makes (span / a, 0.05 and more). `strands`: as found with the groups as supports. Map frame minus an origin, m.
std::vector<char> passed_by_wires(const std::vector<WirePoint>& points, const std::vector<Strand>& strands,
                                  const std::vector<TowerGroup>& groups, const StrandOptions& o);

}  // namespace swath::terrain
