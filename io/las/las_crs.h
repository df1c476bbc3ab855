// SPDX-License-Identifier: GPL-3.0-or-later
// The coordinate reference system of a LAS file: WKT or GeoTIFF keys.
#pragma once

#include <string>

#include "io/las/las_header.h"

namespace swath::io {

/// The coordinate reference system that a file states.
struct LasCrs {
  std::string definition;        ///< for core::Crs, which takes it: WKT, "EPSG:26910", "EPSG:26910+5703"; empty: none stated
  double vertical_metres = 0.0;  ///< metres per unit of height by VerticalUnitsGeoKey; 0 not stated there
  std::string note;              ///< why a stated CRS could not be used
};
/// The WKT record where it is understood, else the GeoTIFF keys: codes, the vertical codes of GeoTIFF 1.0 (4096 = 5103 is NAVD88 in the
/// unit of 4099; 5001 to 5033 are ellipsoidal heights), the unit of ProjLinearUnitsGeoKey where that is not the code's, and systems defined
/// parameter by parameter.
LasCrs las_crs(const LasHeader& header);

/// The WKT record (R15, 3.4) for `header.vlrs`, as an extended record where it is longer than 65535 bytes.
void add_las_wkt(LasHeader& header, const std::string& wkt);

}  // namespace swath::io
