// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

namespace swath::terrain {

/// A rectangle of the Block's frame, m; its border belongs to it.
struct Rectangle {
  double west = -std::numeric_limits<double>::infinity(), south = west;
  double east = std::numeric_limits<double>::infinity(), north = east;
};

}  // namespace swath::terrain
