// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"
#include "core/config/option.h"
#include "core/grid.h"

namespace swath::terrain {

struct SpikeFreeOptions {
  core::Metres freeze{1.0};
  core::Metres buffer{0.5};
};

template <class V>
void describe(SpikeFreeOptions& o, V& v) {
  v.option("freeze", o.freeze, core::above(0.0), "spike_free: triangles with all edges shorter than this stay; about three pulse spacings.",
           "Khosravipour2016");
  v.option("buffer", o.buffer, core::at_least(0.0), "spike_free: a point this little below a closed triangle's lowest corner still enters.",
           "Khosravipour2016");
}

/// Of `rows` those that a spike-free surface passes through, for every point within `reach` of the window: from the highest down, a point
/// enters the TIN unless it falls into a triangle that is closed. Each patch of an absolute lattice is worked by itself with a border
/// around it, so that the choice does not depend on the tiling.
std::vector<std::uint32_t> spike_free_rows(const core::Block& block, const std::vector<std::uint32_t>& rows, const core::Lattice& window,
                                           double reach, const SpikeFreeOptions& options);

/// Metres of points that spike_free_rows() needs beyond its reach.
double spike_free_halo(const SpikeFreeOptions& options);

}  // namespace swath::terrain
