// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/versions.h"

#include <gdal.h>
#include <proj.h>

namespace swath::io {

core::Value library_versions() {
  core::Value out = core::Value::object();
  out["GDAL"] = GDALVersionInfo("RELEASE_NAME");
  out["PROJ"] = proj_info().version;
  return out;
}

}  // namespace swath::io
