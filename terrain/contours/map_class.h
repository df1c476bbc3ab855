// SPDX-License-Identifier: GPL-3.0-or-later
// Which contour interval a terrain model carries: the height classes of topographic maps.
#pragma once

#include <array>

namespace swath::terrain {

/// A class of maps: the standard error of heights (EP) that it allows, as a share of the contour interval; nine heights of ten are then
/// within 1.6449 times as much (PEC).
struct MapClass {
  char name;
  double standard_error;  ///< over the interval
};

/// Brazilian decree 89.817 (1984), article 9: EP 1/3 (A), 2/5 (B), 1/2 (C) of the interval; PEC 1/2, 3/5, 3/4.
inline constexpr std::array<MapClass, 3> map_classes{{{'A', 1.0 / 3.0}, {'B', 2.0 / 5.0}, {'C', 1.0 / 2.0}}};

/// The best class that a model of standard deviation `sigma` keeps with contours every `interval` (one unit); '-' where it keeps none.
char map_class_of(double interval, double sigma);

/// The smallest interval that a model of standard deviation `sigma` carries in a class.
double smallest_interval(const MapClass& c, double sigma);

/// The smallest interval of the usual series 1, 2, 2.5, 5 times a power of ten that is not less than `interval`.
double usual_interval(double interval);

}  // namespace swath::terrain
