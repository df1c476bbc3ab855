// SPDX-License-Identifier: GPL-3.0-or-later
// Breaklines, boundaries and water lines from any vector file that GDAL reads.
#pragma once

#include <string>
#include <vector>

#include "core/breakline.h"
#include "core/report.h"
#include "io/survey/breakline_file.h"

namespace swath::io {

struct Survey;

/// All features of the survey's breakline files, in the files' order, in the survey's CRS (units of its axes; `crs` is the products', for a
/// survey that states none). Lakes and rivers may have no heights. Throws Error with file and feature: geometries that do not suit the
/// kind, breaklines without heights, coordinates not finite, a CRS without an operation to it, heights whose datum is not known while the
/// survey's is.
std::vector<core::Breakline> read_breaklines(const Survey& survey, const std::string& crs, core::Tally& tally);

}  // namespace swath::io
