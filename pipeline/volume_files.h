// SPDX-License-Identifier: GPL-3.0-or-later
// `swath volumes`: cut and fill between two terrain models, or from one to a design height.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/config/value.h"

namespace swath::pipeline {

struct VolumeRequest {
  std::filesystem::path before, after;  ///< rasters; `after` empty where a design height stands for it
  std::optional<double> design;         ///< unit of the heights of `before`
  std::filesystem::path polygon;        ///< vector file with rings, or empty
  double correlation = 1.0;             ///< of the errors of any two cells of a model
};

/// Volumes in m3, areas in m2 (units of the file where it states no CRS), with sigma where both models have it. Surfaces on different
/// lattices are compared on the finer one. Throws core::Error: files that cannot be read, CRSs that differ, no cell in common.
core::Value volumes_of(const VolumeRequest& request);
std::string volume_text(const core::Value& told);

}  // namespace swath::pipeline
