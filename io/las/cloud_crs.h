// SPDX-License-Identifier: GPL-3.0-or-later
// The coordinate reference systems of point clouds: what the survey says of them, else what they state themselves.
#pragma once

#include <filesystem>
#include <string>

#include "core/geo/crs.h"
#include "io/survey/survey.h"

namespace swath::io {

/// A .prj beside a cloud that states no CRS: what a hint says of it. It is not taken unasked: it may be of another file's coordinates.
struct CrsBeside {
  std::string stated{};                ///< "a.prj beside it states NAME: "; empty where there is none that is understood
  std::string example = "EPSG:25832";  ///< the CRS to name: its code, EPSG:CODE where the file states none
};
CrsBeside crs_beside(const std::filesystem::path& cloud);

/// What states the CRS of a cloud: WKT, "EPSG:32632" ... Throws core::Error that names points.crs where neither survey nor file states it.
std::string cloud_definition(const Survey& survey, const PointFile& file);
/// The CRS itself. Throws core::Error also where it is not understood.
core::Crs cloud_crs(const Survey& survey, const PointFile& file);

/// Holds every cloud against the CRS of the run (that of the first where the survey states none). Throws core::Error: a CRS not stated,
/// heights of one system where the other's is not stated, a transformation or its grid that is not there.
void check_clouds(const Survey& survey);

/// What the heights of a run on clouds in a CRS that does not state it count from: ellipsoidal where every cloud says so.
std::string heights_of_clouds(const Survey& survey);

/// Metres of one unit of the cloud's heights: what the survey states of the file, else its CRS, else `stated` by the file (0: nothing),
/// else the survey's height_unit, else the unit of the horizontal axes.
double height_unit(const Survey& survey, const PointFile& file, const core::Crs& crs, double stated);

}  // namespace swath::io
