// SPDX-License-Identifier: GPL-3.0-or-later
// The table of survey.toml that says where photographs and their orientations are.
#pragma once

#include <filesystem>
#include <string>

#include "core/config/option.h"

namespace swath::io {

/// Photographs whose orientation is known, or comes from the run.
struct PhotoFiles {
  std::filesystem::path folder, orientation, camera;
  std::string crs;
};

template <class V>
void describe(PhotoFiles& p, V& v) {
  v.option("folder", p.folder, "Folder of the photographs, as the camera took them; files have the images' names.");
  v.option("orientation", p.orientation, "Table of orientations, as orientation.csv of `swath block`; without it the run's own.");
  v.option("camera", p.camera, "Table of cameras: camera.toml of `swath block`; without it that of the run's block, or [[camera]].");
  v.option("crs", p.crs, "CRS of the orientations, where their table does not state one; without it the survey's.");
}

}  // namespace swath::io
