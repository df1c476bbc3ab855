// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/geo/undulation.h"

#include <limits>

#include "core/error.h"

namespace swath::core {

double undulation(const Place& place) {
  try {
    return -Transform(wgs84_geodetic(), Crs("EPSG:4326+5773"))({place.longitude, place.latitude, 0.0}).z();
  } catch (const SystemError&) {
    throw;
  } catch (const Error&) {
    return std::numeric_limits<double>::quiet_NaN();
  }
}

}  // namespace swath::core
