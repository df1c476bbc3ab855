// SPDX-License-Identifier: GPL-3.0-or-later
// Distances of stations along strips against those that the image points show: what an exposure without an event leaves.
#pragma once

#include <vector>

#include "calib/block/block_reading.h"

namespace swath::calib {

/// Two images of a strip, one after the other.
struct StationBase {
  std::uint32_t from = 0, to = 0;
  double ratio = 1.0;  ///< of the stations' distance and the one that image points show, over its neighbours' in the strip
};

/// Pairs with common points, a base of a twentieth of the flying height or more, and neighbours to compare with. Positions are those of the
/// stations, attitudes known to a degree or so.
std::vector<StationBase> station_bases(const ImageBlock& block);

/// Throws core::Error where a distance is about twice its neighbours', or next to nothing.
void refuse_broken_bases(const ReadBlock& read, const BlockConfig& config);

}  // namespace swath::calib
