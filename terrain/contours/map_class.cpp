// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/contours/map_class.h"

#include <cmath>

namespace swath::terrain {
namespace {
constexpr double rounding = 1e-9;  // relative, so that 3 * 0.1 carries 0.3
}

char map_class_of(double interval, double sigma) {
  for (const MapClass& c : map_classes)
    if (sigma <= c.standard_error * interval * (1.0 + rounding)) return c.name;
  return '-';
}

double smallest_interval(const MapClass& c, double sigma) { return sigma / c.standard_error; }

double usual_interval(double interval) {
  if (!(interval > 0.0)) return 0.0;
  const double decade = std::pow(10.0, std::floor(std::log10(interval)));
  for (const double step : {1.0, 2.0, 2.5, 5.0})
    if (step * decade >= interval * (1.0 - rounding)) return step * decade;
  return 10.0 * decade;
}

}  // namespace swath::terrain
