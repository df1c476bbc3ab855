// SPDX-License-Identifier: GPL-3.0-or-later
// Bridge decks that a ground filter took for ground: they join the ground at both ends, so that it cannot see the water below.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"
#include "filters/classes/plane_samples.h"

namespace swath::filters {

/// Metres of points around a place that ground_decks depends on there.
double ground_decks_halo(double longest);

/// 1 for each of the first `own` points that lies on a deck of at most `longest` (m) made of ground returns: a strip 2 to 30 m wide beside
/// which, on both sides, the returns lie lower by a metre and more steeply than banks fall, or no beam came back over 5 m or more, while
/// lengthwise it goes on over ground at both ends; near these narrower voids do. Crowns over what is beside it are looked through. And for
/// railings: returns other than ground up to 1.3 m above its edges, within a metre of its cells. Banks, dikes and dams whose sides slope
/// are not decks, nor is ground beside a wall, nor ground between buildings or under trees: what hides the ground says nothing. Where
/// returns are so thin that cells are 3 m wide a void says nothing either. Needs column classification (with ground); does not depend on
/// the order of the points.
std::vector<std::uint8_t> ground_decks(const core::Block& b, const Districts& where, double longest, size_t own);

}  // namespace swath::filters
